// Lower bounds of a timed frame, and what queueing theory predicts for it, both from the work that was
// counted.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "processors/theory/closed_network.h"

namespace marti::processors::replay {

/// No frame with this work can end earlier, in whatever order: each resource does one thing at a time.
struct FrameBounds {
  sim::Ticks node_work = 0;        ///< largest work of one node: its time without waits and idling
  std::uint32_t busiest_node = 0;  ///< the node with that work
  sim::Ticks mean_work = 0;        ///< mean work of all nodes that had any, rounded down
  sim::Ticks interconnect = 0;     ///< busy time per link, of the busiest cluster; 0 for an ideal one
  sim::Ticks bank = 0;             ///< least time from the busiest bank's first start to its last data

  [[nodiscard]] sim::Ticks least() const;
};

/// Whether the node took any part in the frame: a packet, a step, a ray or a branch to build.
[[nodiscard]] bool had_work(const cost::NodeStatistics& node);

[[nodiscard]] FrameBounds frame_bounds(const machine::MachineConfig& config, const MachineResult& result);

/// Throws InternalError when the frame ended before its bounds.
void check_bounds(const machine::MachineConfig& config, const MachineResult& result);

/// One cluster as a closed network: its nodes that had work are the customers, a cycle is one read of the
/// interconnect. Times are picoseconds. Queues are the banks, the crossbar's links, and the bus; a bus that
/// is held while a bank works stands for the banks too. The time of posted writes at a queue counts as demand
/// of the cycle that they belong to and is subtracted from the think time. Think time is the rest of the
/// nodes' time other than idling and waits for the interconnect, a bank or room in a buffer.
struct Prediction {
  std::uint32_t cluster = 0;
  std::int64_t reads = 0;
  theory::ClosedNetwork network;
  // Frame times: number of reads divided by throughput.
  double asymptotic_low = 0.0;
  double balanced_low = 0.0;
  double balanced_high = 0.0;
  double mean_value = 0.0;
  bool exact = true;  ///< the mean values are exact, not approximated
};

/// The prediction for the cluster with the longest predicted frame (by mean values). std::nullopt when no
/// node reads over an interconnect, the frame takes no time, nodes have several reads outstanding (contexts,
/// prefetching), the database is distributed, or the memory is one of DRAM.
[[nodiscard]] std::optional<Prediction> predict(const machine::MachineConfig& config,
                                                const MachineResult& result);

}  // namespace marti::processors::replay
