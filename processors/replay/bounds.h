// What a timed frame could not have beaten, and what queueing theory would have predicted for it, from the
// work that was counted.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "processors/theory/closed_network.h"

namespace marti::processors {

/// No frame with this work can end earlier, whatever waits for what: every resource does one thing at a time.
struct FrameBounds {
  sim::Ticks node_work = 0;        ///< the most that one node does itself: its time without waits and idling
  std::uint32_t busiest_node = 0;  ///< which
  sim::Ticks mean_work = 0;        ///< the same over all nodes that had work, rounded down
  sim::Ticks interconnect = 0;     ///< busy time a link, of the busiest cluster; 0 for an ideal one
  sim::Ticks bank = 0;             ///< from the first start of the busiest bank to its last data, at least

  [[nodiscard]] sim::Ticks least() const;
};

/// Whether the node took any part in the frame: a packet, a step, a ray or a branch to build.
[[nodiscard]] bool had_work(const NodeStatistics& node);

[[nodiscard]] FrameBounds frame_bounds(const MachineConfig& config, const MachineResult& result);

/// Throws InternalError when the frame ended before its bounds.
void check_bounds(const MachineConfig& config, const MachineResult& result);

/// One cluster as a closed network: its nodes that had work are the customers, a cycle is one read of the
/// interconnect. Times are picoseconds. Queues are the bus, unless it is held with a bank inside, the banks
/// and the crossbar's links; what posted writes take of them counts to the cycle that they belong to, and as
/// much less is thought. Think time is all the rest of the nodes' time that is not waiting for the
/// interconnect, a bank or room in a buffer, and not idle.
struct Prediction {
  std::uint32_t cluster = 0;
  std::int64_t reads = 0;
  ClosedNetwork network;
  // Frame times, reads by throughput.
  double asymptotic_low = 0.0;
  double balanced_low = 0.0;
  double balanced_high = 0.0;
  double mean_value = 0.0;
  bool exact = true;  ///< the mean values are not approximated
};

/// Of the cluster for which the mean values predict the longest frame; nothing when no node reads over an
/// interconnect, the frame takes no time, nodes have several reads outstanding (contexts, prefetching), or
/// the database is distributed.
[[nodiscard]] std::optional<Prediction> predict(const MachineConfig& config, const MachineResult& result);

}  // namespace marti::processors
