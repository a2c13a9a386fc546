// Time in the second implementation: delayed actions, and the order of actions within one instant.
//
// SystemC says nothing about the order of processes that run in one delta cycle, so nothing here depends on
// it. Two modules divide an instant:
//
// - Later runs what a component does after a delay. All that was scheduled for an instant before it began is
//   run in the instant's first delta cycle. A delay of zero takes one more delta cycle and holds back all
//   turns until it has passed.
// - A component that is about to use a shared resource asks Turns for leave. Turns gives leave to one
//   at a time, in the order of docs/internals/model.md: the smallest (turn, node) of those that ask, each
//   time only after all consequences of the last leave within the instant have happened.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <systemc>
#include <utility>

namespace marti::oracle {

/// Picoseconds, as everywhere in the project; SystemC's resolution is left at its default of one picosecond.
using Time = std::int64_t;

[[nodiscard]] inline Time now() { return static_cast<Time>(sc_core::sc_time_stamp().value()); }
[[nodiscard]] inline sc_core::sc_time duration(Time ticks) {
  return sc_core::sc_time::from_value(static_cast<sc_dt::uint64>(ticks));
}

/// In the order in which they are given at equal times.
enum class Turn : std::uint8_t { dispatch, reply, read, write };

class TurnTaker {
 public:
  virtual ~TurnTaker() = default;
  /// The turn that was asked for has come.
  virtual void take_turn(Turn turn, std::uint32_t node) = 0;
};

class Turns : public sc_core::sc_module {
 public:
  explicit Turns(const sc_core::sc_module_name& name);
  /// Asks for a turn within the present instant. A node asks for one turn of a kind at a time.
  void ask(Turn turn, std::uint32_t node, TurnTaker& taker);
  /// An action without delay is pending; no turn is given before as many releases.
  void hold() { ++held_; }
  void release() { --held_; }

 private:
  void give();

  std::map<std::pair<Turn, std::uint32_t>, TurnTaker*> asked_;
  int held_ = 0;
  sc_core::sc_event next_;
};

class Later : public sc_core::sc_module {
 public:
  Later(const sc_core::sc_module_name& name, Turns& turns);
  /// Does `what` when `delay` has passed. Equal times keep the order of the calls.
  void after(Time delay, std::function<void()> what);

 private:
  struct Entry {
    std::function<void()> what;
    bool holds = false;
  };
  void run();

  Turns& turns_;
  std::multimap<Time, Entry> entries_;
  sc_core::sc_event due_;
};

}  // namespace marti::oracle
