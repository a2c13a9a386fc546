// The processor nodes of a machine, replaying a work log.
//
// A node's hits touch no shared state, so a node runs ahead through them without events. It stops where it
// meets something shared: a miss, a pixel write, a request to the host. The result is the same as with an
// event for every reference (`step_by_step`), which tests prove.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "memory/interconnect.h"
#include "processors/cost/accounting.h"
#include "processors/node/build_result.h"
#include "processors/node/host.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/context_result.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/second_level.h"
#include "processors/walk/simt_result.h"
#include "sim/engine.h"

namespace marti::processors::node {

/// Event classes. At equal times a node's own progress comes before requests to the host, replies come before
/// new requests (an interconnect's data do not wait for an address of the same instant), and reads before
/// writes. `memory` comes last: what the memory system does by itself after all requests of the instant.
enum class EventClass : std::uint8_t { step, dispatch, reply, read, write, memory };

/// The nodes of all clusters as one event handler; node n is port n % nodes of cluster n / nodes.
class NodeArray : public sim::EventHandler {
 public:
  /// Posts each node's first event, in an order drawn from `seed` (0: ascending); the result is the same.
  virtual void start(std::uint64_t seed) = 0;
  /// Handles all events of `engine`. No limit is needed: each event moves a node or a ray on by at least one
  /// step of a finite log, or is the only one at its node or cluster that finds nothing to do.
  virtual void run_all(sim::Engine& engine) { engine.run(std::numeric_limits<std::uint64_t>::max()); }
  /// For nodes of a part of a machine (walk::MachinePart), if can_be_parts(). run_before(): run_all() for the
  /// events before `end`. grant(): the answer to a request of a packet, std::nullopt if none was left.
  /// end_not_before(): after the run, when the whole machine was done.
  virtual void run_before(sim::Engine& engine, sim::Ticks end);
  virtual void grant(std::uint32_t node, const std::optional<Grant>& grant);
  virtual void end_not_before(sim::Ticks end);
  /// The interconnect of each cluster; set before start().
  virtual void connect(std::vector<memory::Interconnect*> interconnects) = 0;
  /// The client to plug into cluster `cluster`'s interconnect.
  [[nodiscard]] virtual memory::InterconnectClient& client(std::uint32_t cluster) = 0;

  /// During the run: enters in statistics() what has been counted elsewhere so far. The result is the same.
  virtual void settle() {}
  /// After the run: when the last node and the last write were done.
  [[nodiscard]] virtual sim::Ticks end() const = 0;
  /// After the run: fills in idle time and the times that follow from counts.
  virtual void finish() = 0;
  [[nodiscard]] virtual std::vector<cost::NodeStatistics> statistics() const = 0;
  /// After the run: the result of building the tree; empty when the tree is given.
  [[nodiscard]] virtual BuildResult build_result() const { return {}; }
  /// After the run: the counts of private second-level caches; empty when there are none.
  [[nodiscard]] virtual walk::SecondLevelResult second_level() const { return {}; }
  /// After the run: the counts beyond hits and misses that were asked for.
  [[nodiscard]] virtual walk::CacheCountResult cache_counts() const { return {}; }
  /// After the run: the counts of contexts and prefetches; empty when there are none.
  [[nodiscard]] virtual walk::ContextResult context_result() const { return {}; }
  /// After the run: the counts of SIMT nodes; empty with others.
  [[nodiscard]] virtual walk::SimtResult simt_result() const { return {}; }
  /// After the run: the figures of each packet of a sample; empty without a sample.
  [[nodiscard]] virtual std::vector<walk::PacketFigures> packet_figures() const { return {}; }
  /// Host bytes for each simulated node, without its cache tags.
  [[nodiscard]] virtual std::size_t bytes_per_node() const = 0;
};

/// The numbers from 0 to count - 1, in an order drawn from `seed` (0: ascending).
[[nodiscard]] std::vector<std::uint32_t> order_drawn_from(std::uint64_t seed, std::size_t count);

/// Whether the nodes of this machine can be divided into parts.
[[nodiscard]] bool can_be_parts(const walk::ReplayInput& input);

/// Builds the nodes with the look-up code for the configured caches.
[[nodiscard]] std::unique_ptr<NodeArray> make_node_array(const walk::ReplayInput& input, sim::Engine& engine,
                                                         Host& host);

}  // namespace marti::processors::node
