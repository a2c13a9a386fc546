// What all nodes of a replay share and no node changes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/machine/packets.h"
#include "processors/program/work_log.h"
#include "processors/walk/packet_sample.h"
#include "processors/walk/tree_plan.h"
#include "sim/time.h"

namespace marti::processors::walk {

class CauseObserver;
class KeptVisits;
class Observer;
class StrippedLog;

/// References to objects that outlive the replay.
struct ReplayInput {
  const program::WorkLog& log;
  const machine::MachineConfig& config;
  const memory::Layout& layout;
  const machine::PacketList& packets;
  std::span<const std::uint32_t> node_rank;          ///< see node_ranks (record_places.h)
  bool step_by_step = false;                         ///< an event for every reference
  const TreePlan* tree = nullptr;                    ///< how the tree is built; null when it is given
  bool report_built = false;                         ///< report at the end which branches are built
  Observer* observer = nullptr;                      ///< null: no observer
  const StrippedLog* stripped = nullptr;             ///< walked in the log's place; null: the log itself
  bool with_contexts = false;                        ///< nodes that can hold several contexts, even for one
  const PacketSample* sample = nullptr;              ///< null: `packets` are all packets; else these of them
  const machine::PacketList* all_packets = nullptr;  ///< all packets of the frame, when `sample` is set
  /// Number of lines that caches may be asked for and never replace; 0: their tags are looked up.
  std::uint64_t line_set = 0;
  /// The time of every read, so that nodes read without events; std::nullopt: they ask the interconnect.
  std::optional<sim::Ticks> own_reads{};
  /// Null: nobody asks for causes. Else there is an observer, too.
  CauseObserver* causes = nullptr;
  /// Null: visits are planned for this replay alone. Else the tree is given.
  KeptVisits* visits = nullptr;
};

}  // namespace marti::processors::walk
