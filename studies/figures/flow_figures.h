// What the catalogue does not have of the schemes in which rays move: how busy stages, nodes and the
// host are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processors/replay/replay.h"

namespace marti::studies::figures {

/// The nodes of one stage of all clusters, or all nodes where there are no stages.
struct StageLoad {
  std::string name;  ///< "search", "nearest", "shade"; "nodes" where there are no stages
  std::uint64_t nodes = 0;
  sim::Sum work = 0;        ///< time of all of them without waits for rays or queues and without idling
  double busy = 0.0;        ///< mean share of the frame without waits for rays or queues and without idling
  double busiest = 0.0;     ///< that share for the busiest node
  double queue_full = 0.0;  ///< mean share of the frame in which a node waits for a full queue
  std::int64_t longest_queue = 0;

  /// Largest over mean busy time; std::nullopt when no node was busy.
  [[nodiscard]] std::optional<double> imbalance() const {
    return busy > 0.0 ? std::optional(busiest / busy) : std::nullopt;
  }
};

struct FlowFigures {
  StageLoad all;
  std::vector<StageLoad> stages;  ///< empty where there are none
  double host = 0.0;       ///< share of the frame in which the host sends camera rays, mean of the clusters
  double host_link = 0.0;  ///< share in which contributions occupy its link; 0 for an ideal network or a bus

  /// The stage whose nodes are busiest; where there are no stages, all nodes.
  [[nodiscard]] const StageLoad& slowest() const;
};

/// `result` must be of a scheme in which rays move.
[[nodiscard]] FlowFigures flow_figures(const processors::machine::MachineConfig& machine,
                                       const processors::replay::MachineResult& result);

}  // namespace marti::studies::figures
