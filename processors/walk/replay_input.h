// What all nodes of a replay share and no node changes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/machine/packets.h"
#include "processors/program/work_log.h"
#include "processors/walk/packet_sample.h"
#include "processors/walk/tree_plan.h"
#include "sim/event.h"
#include "sim/time.h"

namespace marti::processors::walk {

class CauseObserver;
class KeptVisits;
class Observer;
class StrippedLog;

/// A node's request of its next packet.
struct PacketRequest {
  sim::Event turn;  ///< when, among all that the machine does (sim::Engine::turn())
  std::uint32_t node = 0;
};

/// What distinguishes the nodes of a part of a machine that has an engine of its own. The part's
/// configuration is that of a machine with so many nodes less, and its nodes are numbered from 0.
struct MachinePart {
  std::uint32_t first_node = 0;  ///< the number of its node 0 in the whole machine
  /// The host answers requests later, because the other parts' requests may come before them: they are left
  /// in `requests`, and answered by NodeArray::grant().
  bool asks_later = false;
  std::vector<PacketRequest> requests{};
};

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
  /// Null: the nodes are those of the whole machine.
  MachinePart* part = nullptr;
  /// Threads beside the calling one that may do what nodes do while they wait (node/work_ahead.h).
  unsigned helpers = 0;

  /// All this for another machine.
  [[nodiscard]] ReplayInput with_config(const machine::MachineConfig& other) const {
    return {log,          other,    layout,   packets,       node_rank, step_by_step, tree,
            report_built, observer, stripped, with_contexts, sample,    all_packets,  line_set,
            own_reads,    causes,   visits,   part,          helpers};
  }
};

}  // namespace marti::processors::walk
