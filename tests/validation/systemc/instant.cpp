#include "tests/validation/systemc/instant.h"

#include "sim/error.h"

namespace marti::oracle {

Turns::Turns(const sc_core::sc_module_name& name) : sc_module(name) {
  SC_HAS_PROCESS(Turns);
  SC_METHOD(give);
  sensitive << next_;
  dont_initialize();
}

void Turns::ask(Turn turn, std::uint32_t node, TurnTaker& taker) {
  sim::ensure(asked_.emplace(std::pair(turn, node), &taker).second, "a node asked twice for one turn");
  next_.notify(sc_core::SC_ZERO_TIME);
}

void Turns::give() {
  if (asked_.empty()) {
    return;
  }
  if (held_ == 0) {
    const auto first = asked_.begin();
    const auto [turn, node] = first->first;
    TurnTaker* const taker = first->second;
    asked_.erase(first);
    taker->take_turn(turn, node);
  }
  if (!asked_.empty()) {
    next_.notify(sc_core::SC_ZERO_TIME);
  }
}

Later::Later(const sc_core::sc_module_name& name, Turns& turns) : sc_module(name), turns_(turns) {
  SC_HAS_PROCESS(Later);
  SC_METHOD(run);
  sensitive << due_;
  dont_initialize();
}

void Later::after(Time delay, std::function<void()> what) {
  const bool holds = delay == 0;
  if (holds) {
    turns_.hold();
  }
  entries_.emplace(now() + delay, Entry{std::move(what), holds});
  due_.notify(duration(delay));  // an earlier notification that is pending stays
}

void Later::run() {
  while (!entries_.empty() && entries_.begin()->first <= now()) {
    const Entry entry = std::move(entries_.begin()->second);
    entries_.erase(entries_.begin());
    entry.what();
    if (entry.holds) {
      turns_.release();
    }
  }
  if (!entries_.empty()) {
    due_.notify(duration(entries_.begin()->first - now()));
  }
}

}  // namespace marti::oracle
