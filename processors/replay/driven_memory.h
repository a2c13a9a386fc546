// A cluster's shared memory by itself: its interconnect, shared second level, banks or DRAM serve requests
// from anywhere, in the place of nodes that trace rays. The private caches of the nodes may be before it.
#pragma once

#include <cstdint>
#include <functional>

#include "memory/wait_statistics.h"
#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "processors/walk/observer.h"
#include "sim/work_meter.h"

namespace marti::processors::replay {

/// A request of a trace, within one line where there are caches.
struct DrivenRequest : walk::Request {
  memory::RecordKind kind = memory::RecordKind::node;  ///< says which of split caches it goes to
};

/// Requests are asked for in their order. A request comes at its time, but not before its node has a place
/// for it: each node has `outstanding` places for reads, each a port of the interconnect, and a write buffer
/// as the configuration says. Those behind wait.
struct DrivenOptions {
  std::uint32_t outstanding = 16;  ///< at least 1
  /// Whether a request comes at its time; otherwise as soon as its node has a place for it.
  bool timed = true;
  /// Whether reads are first looked up in the node's private caches, which a read holds until its line is
  /// there. A line under way is waited for, even if another one has taken its place. Writes go past the
  /// caches.
  bool caches = false;
  sim::WorkMeter* meter = nullptr;  ///< counts the requests; null: nobody waits
};

struct DrivenResult {
  /// With `end`, when the last request was done, and one cluster; without nodes. Its energy, if that is on,
  /// is that of caches, interconnect and memory.
  MachineResult machine;
  /// How long reads took from when they came. Untimed ones come when they are asked for.
  memory::WaitStatistics latency;
  std::int64_t late = 0;             ///< timed requests that waited for a place
  cost::ReferenceCounts references;  ///< look-ups in first-level caches, where these are asked
};

/// Gives the next request; false at the end. Times must not decrease where they count, and nodes be below
/// MachineConfig::nodes.
using NextRequest = std::function<bool(DrivenRequest&)>;

/// Throws KeyError for a machine whose nodes do not share a memory, and UserError for a time that does not
/// fit.
[[nodiscard]] DrivenResult drive_memory(const machine::MachineConfig& config, const DrivenOptions& options,
                                        const NextRequest& next);

}  // namespace marti::processors::replay
