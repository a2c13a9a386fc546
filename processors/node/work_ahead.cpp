#include "processors/node/work_ahead.h"

#include <algorithm>
#include <bit>
#include <thread>

#include "processors/walk/left_out.h"
#include "sim/wait_until.h"

namespace marti::processors::node {

namespace {

constexpr std::uint32_t looked_at = 4096;  // nodes
constexpr std::uint32_t most_late = 8;     // one of so many
constexpr std::uint32_t rest = 1U << 16U;

}  // namespace

const char* why_not_ahead(const machine::MachineConfig& config) {
  if (const char* why = walk::why_other_nodes(config)) {
    return why;
  }
  return config.placement == machine::Placement::replicated || walk::why_read_events(config) == nullptr
             ? "no read of a node waits for another"
             : nullptr;
}

// A thread and a ring of rows of nodes, which it works for in the order of their misses.
class WorkAhead::Helper {
 public:
  Helper(WorkAhead& all, std::uint32_t nodes)
      : all_(all),
        rows_(std::bit_ceil(std::max<std::size_t>(4, nodes / row_nodes))),
        mask_(rows_.size() - 1),
        thread_([this] { help(); }) {}
  ~Helper() {
    passed_on_.store(end, std::memory_order_release);
    passed_on_.notify_one();
    thread_.join();
  }
  Helper(const Helper&) = delete;
  Helper& operator=(const Helper&) = delete;

  // Where there is no room, the nodes are left to finish().
  void pass_on(const Nodes& nodes) {
    if (filled_ - seen_.load(std::memory_order_acquire) == rows_.size()) {
      return;
    }
    rows_[filled_++ & mask_] = nodes;
    passed_on_.store(filled_, std::memory_order_release);
    passed_on_.notify_one();
  }

 private:
  static constexpr std::uint64_t end = ~std::uint64_t{0};

  void help() {
    std::uint64_t seen = 0;
    for (std::uint64_t passed_on = 0;;) {
      sim::wait_until(
          [&] {
            passed_on = passed_on_.load(std::memory_order_acquire);
            return passed_on != seen;
          },
          [&] { passed_on_.wait(seen, std::memory_order_acquire); }, patience);
      if (passed_on == end) {
        return;
      }
      const Nodes nodes = rows_[seen & mask_];
      seen_.store(++seen, std::memory_order_release);
      for (std::uint32_t i = 0; i < row_nodes + ahead; ++i) {
        if (i < row_nodes) {
          all_.prepare(nodes[i]);
          all_.work_.prepare_ahead(nodes[i]);
        }
        if (i >= ahead && all_.take(nodes[i - ahead])) {
          all_.help(nodes[i - ahead]);
        }
      }
    }
  }

  static constexpr std::uint32_t ahead = 4;  // nodes prepared before their turn
  // Rows come some microseconds after each other, and waking a thread takes as long.
  static constexpr int patience = 100'000;

  WorkAhead& all_;
  std::vector<Nodes> rows_;
  std::uint64_t mask_;
  std::uint64_t filled_ = 0;  // rows entered so far
  alignas(64) std::atomic<std::uint64_t> passed_on_ = 0;
  alignas(64) std::atomic<std::uint64_t> seen_ = 0;  // rows that the helper has taken out
  std::thread thread_;
};

WorkAhead::WorkAhead(unsigned helpers, std::uint32_t nodes, NodeWork& work)
    : work_(work), nodes_(nodes), rows_(helpers) {}

WorkAhead::~WorkAhead() = default;

WorkAhead::Team::Team(WorkAhead& all) : all_(all) {
  const std::size_t helpers = all.rows_.size();
  const auto nodes = static_cast<std::uint32_t>(all.nodes_.size() / helpers);
  for (std::size_t helper = 0; helper < helpers; ++helper) {
    all.helpers_.push_back(std::make_unique<Helper>(all, nodes));
  }
}

WorkAhead::Team::~Team() { all_.helpers_.clear(); }

// What the helpers do is worth its price if it is in time. Where memory answers soon, or the computer has
// other work to do, it is not, at least for a while.
void WorkAhead::pass_on(std::size_t helper) {
  helpers_[helper]->pass_on(rows_[helper].nodes);
  rows_[helper].filled = 0;
  begun_ += row_nodes;
  if (begun_ >= looked_at) {
    rest_ = late_ > begun_ / most_late ? rest : 0;
    begun_ = 0;
    late_ = 0;
  }
}

void WorkAhead::finish_late(std::uint32_t node) {
  Ahead& ahead = nodes_[node];
  const bool left_to_helpers = ahead.state_.load(std::memory_order_relaxed) != State::idle;
  late_ += left_to_helpers ? 1 : 0;
  if (!left_to_helpers || take(node)) {
    work_.work_ahead(node, ahead);
    return;
  }
  State state = State::taken;
  sim::wait_until(
      [&] {
        state = ahead.state_.load(std::memory_order_acquire);
        return state != State::taken;
      },
      [] { std::this_thread::yield(); });
  if (state == State::failed) {
    const std::lock_guard lock(fault_lock_);
    std::rethrow_exception(fault_);
  }
}

void WorkAhead::help(std::uint32_t node) noexcept {
  State state = State::done;
  try {
    work_.work_ahead(node, nodes_[node]);
  } catch (...) {
    state = State::failed;
    const std::lock_guard lock(fault_lock_);
    if (fault_ == nullptr) {
      fault_ = std::current_exception();
    }
  }
  nodes_[node].state_.store(state, std::memory_order_release);
}

}  // namespace marti::processors::node
