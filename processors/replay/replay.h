// Times one machine from a work log.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "memory/distributed.h"
#include "memory/interconnect.h"
#include "processors/cost/accounting.h"
#include "processors/energy/energy.h"
#include "processors/flow/flow_result.h"
#include "processors/machine/machine_config.h"
#include "processors/node/build_result.h"
#include "processors/node/host.h"
#include "processors/program/work_log.h"
#include "processors/walk/build_start.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/context_result.h"
#include "processors/walk/left_out.h"
#include "processors/walk/packet_sample.h"
#include "processors/walk/second_level.h"
#include "processors/walk/simt_result.h"
#include "sim/work_meter.h"

namespace marti::processors::path {
class PathRecorder;
}  // namespace marti::processors::path
namespace marti::processors::walk {
class KeptVisits;
class Observer;
class StrippedLog;
}  // namespace marti::processors::walk

namespace marti::processors::replay {

/// What a cluster's distributed memory counted in addition to the counts of every interconnect.
struct DistributedResult {
  memory::DistributedStatistics accesses;
  memory::NetworkStatistics network;
};

/// What one cluster's interconnect and banks counted. For a distributed memory: its network and each node's
/// memory.
struct ClusterResult {
  memory::InterconnectStatistics interconnect;
  std::vector<memory::BankStatistics> banks;
  std::optional<DistributedResult> distributed{};
  std::vector<memory::DramStatistics> dram{};  ///< of each channel, if the memory is one of DRAM
};

/// A timed frame. All figures are integers; ratios are computed where they are printed.
struct MachineResult {
  sim::Ticks end = 0;  ///< when the last node and the last posted write are done: the frame time
  std::vector<cost::NodeStatistics> nodes;
  std::vector<ClusterResult> clusters;
  node::HostStatistics host;
  node::BuildResult build;                          ///< empty when the tree is given
  flow::FlowResult flow;                            ///< empty with the image scheme
  walk::ContextResult contexts;                     ///< empty with one context and no prefetch
  walk::SimtResult simt;                            ///< empty with nodes of another kind
  walk::SecondLevelResult l2;                       ///< empty without a second level
  walk::CacheCountResult counts;                    ///< the counts that MachineConfig::count asks for
  std::uint64_t packets = 0;                        ///< number handed out
  std::uint64_t pixels = 0;                         ///< image scheme: number of pixels in these packets
  std::vector<walk::PacketFigures> packet_figures;  ///< with a sample: of its packets, in order; else empty
  std::uint64_t database_bytes = 0;                 ///< of one copy, when the frame begins
  std::uint64_t copies = 0;  ///< one for each cluster, or for each node when replicated
  std::uint64_t events = 0;
  std::optional<energy::EnergyResult> energy;  ///< where MachineConfig::energy is on
  walk::LeftOut left_out;
  bool leaf_records = true;  ///< whether the tree's leaves have node records
  std::size_t host_bytes_per_node = 0;
  sim::Ticks unloaded_miss = 0;  ///< time of a miss that meets no other transaction

  [[nodiscard]] cost::StepCounts steps() const;
  [[nodiscard]] cost::ReferenceCounts references() const;
  [[nodiscard]] cost::TimeSums time() const;
};

/// What a frame has counted at the end of each of its intervals.
struct Intervals {
  sim::Ticks length = 0;  ///< of each interval, at least 1
  /// Is told the result so far: before the frame begins, with `end` = 0, and then after each whole interval
  /// of the frame, with the time as `end`. It has what is counted by events before that time, energy included
  /// and the times of nodes left out. The time that a link or a bank will be held is counted when it is asked
  /// for.
  std::function<void(const MachineResult&)> counted;
};

struct ReplayOptions {
  bool step_by_step = false;     ///< an event for every reference instead of running ahead; same result
  std::uint64_t start_seed = 0;  ///< order in which the nodes' first events are posted; same result
  /// The state of each branch when the frame begins, one entry a tree node, instead of what
  /// MachineConfig::build says; its `sharing` must not be `given`, and with `none` no branch may be lazy.
  /// Empty: as it says.
  std::vector<walk::BranchStart> starts{};
  bool report_built = false;           ///< fill BuildResult::built, unless the tree is given
  walk::Observer* observer = nullptr;  ///< see processors/walk/observer.h; same result
  /// Walked in place of `log`, from which it was made for a machine of the same key_of and ways_of; same
  /// result.
  const walk::StrippedLog* stripped = nullptr;
  /// Look up tags, and post an event for each read, even where left_out.h says that the outcome is known;
  /// same result except for `events` and `left_out`.
  bool keep_lookups = false;
  bool keep_read_events = false;
  /// Only these packets are handed out; the result is that of a frame which has no others. For the image
  /// scheme with a given tree, dynamic assignment, one context, and no second level of caches or counting of
  /// more than hits and misses (check_sampled).
  const walk::PacketSample* sample = nullptr;
  /// Not 0: each 16 packets in a row are handed out in an order that is drawn from it, after those before
  /// them. The frame is as much the machine's as that of the order that it asks for. Not with `sample`.
  std::uint64_t packet_seed = 0;
  bool with_contexts = false;  ///< nodes that can hold several contexts and prefetch, even for one context;
                               ///< same result
  /// Planned visits of the last of several replays of one tree that is given, one after the other; null: none
  /// are kept. Same result.
  walk::KeptVisits* visits = nullptr;
  /// Records the critical path; `observer` must be it or pass all calls on to it. Same result. Not with
  /// `stripped` or `sample`.
  path::PathRecorder* path = nullptr;
  /// Null: nobody asks for intervals; else the replay is one step by step. Same result. `observer` must be
  /// there; not with `stripped` or `sample`.
  const Intervals* intervals = nullptr;
  /// How many threads may time the machine, if it has so many nodes: in parts (machine_parts.h), or some of
  /// them ahead of one (node/work_ahead.h). Same result.
  unsigned threads = 1;
  unsigned parts = 0;  ///< 0: as many as pay
  std::uint32_t fewest_nodes_of_threads = 1024;
  /// Counts each packet that is handed out; after its stop() the replay throws sim::Stopped at the next one.
  /// Null: nobody waits. Same result.
  sim::WorkMeter* meter = nullptr;
};

/// Times `config` on `log`. Deterministic; many replays may share one log. Before it
/// returns it checks the conservation laws of the result and throws InternalError when one is broken.
/// Throws UserError for a machine that cannot be built or a time that does not fit.
[[nodiscard]] MachineResult replay(const program::WorkLog& log, const machine::MachineConfig& config,
                                   const ReplayOptions& options = {});

/// Why one thread times such a machine, however many there may be; null where several do.
[[nodiscard]] const char* why_one_thread(const machine::MachineConfig& config, std::uint32_t fewest_nodes);

/// Sets the energy of the result to that of `config`, which may differ in figures of energy from the machine
/// that was replayed. Throws UserError when it does not fit.
void work_out_energy(const program::WorkLog& log, const machine::MachineConfig& config,
                     MachineResult& result);

/// Throws UserError with the reason when some of the machine's packets cannot be replayed without the others.
void check_sampled(const machine::MachineConfig& config);

/// The conservation laws that every result must obey. Each node's time adds up to the end. Every pixel is
/// written once; where rays move, every ray of the log is made, traced and ended once and every message
/// arrives. The nodes' waits are those that the interconnect and the banks caused. The counts of what was
/// built agree with the trees that exist.
void check_conservation(const program::WorkLog& log, const machine::MachineConfig& config,
                        const MachineResult& result);

}  // namespace marti::processors::replay
