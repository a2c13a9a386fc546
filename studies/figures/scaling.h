// Figures derived from timed machines: speed-up, efficiency, and where most of the nodes' time goes.
#pragma once

#include <optional>
#include <string>

#include "processors/replay/replay.h"

namespace marti::studies {

/// T(1) / T(n) of the same machine with one node, and what follows from it.
struct Scaling {
  std::uint32_t nodes = 1;  ///< of all clusters
  sim::Ticks one_node_end = 0;
  std::optional<double> speed_up;    ///< std::nullopt when the frame takes no time
  std::optional<double> efficiency;  ///< speed_up / nodes
  /// Karp and Flatt 1990: the serial fraction (1/s - 1/n) / (1 - 1/n) that would explain the speed-up by
  /// Amdahl's law; std::nullopt for one node.
  std::optional<double> serial_fraction;
};

[[nodiscard]] Scaling scaling_of(sim::Ticks one_node_end, sim::Ticks end, std::uint32_t nodes);

/// What connects the nodes to their memory: "ideal interconnect", "bus", "crossbar", or for a distributed
/// database "mesh network" and the like.
[[nodiscard]] std::string interconnect_name(const processors::MachineConfig& machine);

/// How busy interconnects and banks were, as shares of the frame time.
struct Utilisation {
  /// Transfer time / (links * frame time) of the busiest cluster; std::nullopt for an ideal interconnect or
  /// network, which has no links to be busy.
  std::optional<double> interconnect;
  double bank = 0.0;  ///< of the busiest bank; with a distributed database, of the busiest node's memory
  double mean_bank = 0.0;
};

[[nodiscard]] Utilisation utilisation_of(const processors::MachineConfig& machine,
                                         const processors::MachineResult& result);

enum class Limit {
  nothing,
  interconnect,
  bank,
  memory_latency,
  dispatch,
  start_up,
  lock,
  imbalance,
  write_buffer,
  slowest_part,
  queues,
  messages,
  compute
};

/// Where most of the nodes' time goes. It does not say what would help: studies/helps measures that.
struct Finding {
  Limit limit = Limit::nothing;
  double share = 0.0;    ///< of all nodes' time
  std::string sentence;  ///< for people; names the figure it rests on
};

[[nodiscard]] Finding find_limit(const processors::MachineConfig& machine,
                                 const processors::MachineResult& result);

/// The name of a limit in results for programs.
[[nodiscard]] std::string_view name_of(Limit limit);

}  // namespace marti::studies
