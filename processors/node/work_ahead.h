// Work of nodes that helper threads do while the nodes wait for memory.
//
// What a node does after a miss, up to its next miss or the end of its pixel, does not depend on when its
// data come, and touches nothing but the node. So the thread that simulates the memory hands a node over when
// it asks for data, and takes it back when these have come: by then a helper has done the work, counting time
// from 0. Who does it changes no figure, so the result is that of one thread, bit for bit. Where the helpers
// have not begun a node's work in time, the thread does it itself.
//
// zsim (Sanchez, Kozyrakis, ISCA 2013) also separates what cores do by themselves from what they contend for,
// in phases of some thousand cycles.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "memory/interconnect.h"
#include "memory/record_kind.h"
#include "processors/machine/machine_config.h"
#include "processors/walk/log_cursor.h"
#include "sim/prefetch.h"
#include "sim/time.h"

namespace marti::processors::node {

/// How far a node has come by itself. All that threads tell each other of a node lies in one cache line.
struct alignas(64) Ahead {
  sim::Ticks time = 0;  ///< from when its data have come
  memory::Address address = 0;
  std::uint32_t bytes = 0;  ///< with Stop::miss, what it asks for
  walk::Stop stop = walk::Stop::end;

 private:
  friend class WorkAhead;
  enum class State : std::uint8_t { idle, waiting, taken, done, failed };
  std::atomic<State> state_ = State::idle;

 public:
  /// The sums over the reads of the node, kept by the thread that simulates the memory; `done` is not used.
  memory::Service reads{};
};
static_assert(sizeof(Ahead) == 64);

/// What helpers do for a node.
class NodeWork {
 public:
  virtual ~NodeWork() = default;
  /// What `node` has to do after its miss. Called by any thread, for each node by one at a time.
  virtual void work_ahead(std::uint32_t node, Ahead& ahead) = 0;
  /// work_ahead(node) will soon be called by this thread: prefetches what it uses. The node may be at work.
  virtual void prepare_ahead(std::uint32_t node) const = 0;
};

/// Why nodes of this machine cannot work ahead; null when they can.
[[nodiscard]] const char* why_not_ahead(const machine::MachineConfig& config);

/// Used by one thread, whose nodes these are.
class WorkAhead {
 public:
  /// `helpers` is how many threads a team has, at least one.
  WorkAhead(unsigned helpers, std::uint32_t nodes, NodeWork& work);
  ~WorkAhead();
  WorkAhead(const WorkAhead&) = delete;
  WorkAhead& operator=(const WorkAhead&) = delete;

  /// The helpers. There is one team at a time; begin() and finish() are called while there is.
  class Team {
   public:
    explicit Team(WorkAhead& all);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

   private:
    WorkAhead& all_;
  };

  /// Of a node that is not left to the helpers.
  [[nodiscard]] Ahead& of(std::uint32_t node) { return nodes_[node]; }
  /// What belongs to `node` alone is left to the helpers until finish(node), of(node) too.
  void begin(std::uint32_t node) {
    if (rest_ != 0) [[unlikely]] {
      --rest_;
      nodes_[node].state_.store(State::idle, std::memory_order_relaxed);
      return;
    }
    nodes_[node].state_.store(State::waiting, std::memory_order_release);
    const std::size_t helper = rows_.size() == 1 ? 0 : node % rows_.size();
    Row& row = rows_[helper];
    row.nodes[row.filled++] = node;
    if (row.filled == row_nodes) {
      pass_on(helper);
    }
  }
  /// Returns when the node's work is done. Rethrows what that has thrown.
  void finish(std::uint32_t node) {
    if (nodes_[node].state_.load(std::memory_order_acquire) != State::done) [[unlikely]] {
      finish_late(node);
    }
  }
  /// Prefetches what finish(node) looks at.
  void prepare(std::uint32_t node) const { sim::prefetch_line(&nodes_[node]); }

 private:
  using State = Ahead::State;

  // Nodes are passed on to a helper several at a time, because each passing costs both threads some hundred
  // cycles.
  static constexpr std::uint32_t row_nodes = 8;
  using Nodes = std::array<std::uint32_t, row_nodes>;
  struct Row {
    Nodes nodes{};
    std::uint32_t filled = 0;
  };
  class Helper;

  void pass_on(std::size_t helper);
  void finish_late(std::uint32_t node);
  // Whether the node's work has been left to the caller.
  bool take(std::uint32_t node) {
    State state = State::waiting;
    return nodes_[node].state_.compare_exchange_strong(state, State::taken, std::memory_order_acq_rel);
  }
  // Does the work of a node that a helper has taken.
  void help(std::uint32_t node) noexcept;

  NodeWork& work_;
  std::vector<Ahead> nodes_;
  std::vector<Row> rows_;  // by helper, those not passed on yet
  std::uint32_t begun_ = 0;
  std::uint32_t late_ = 0;  // of these, nodes whose work was not done when their data came
  std::uint32_t rest_ = 0;  // so many nodes are not left to the helpers, who are too late for most
  std::mutex fault_lock_;
  std::exception_ptr fault_;  // of the helper that was the first to fail
  std::vector<std::unique_ptr<Helper>> helpers_;
};

}  // namespace marti::processors::node
