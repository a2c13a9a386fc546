// How machines of several schemes grow with the number of their nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "studies/figures/figure_parts.h"
#include "studies/figures/find_limit.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/schemes/tree_tables.h"
#include "studies/tables/table.h"

namespace marti::studies::schemes {

/// One machine with one number of nodes.
struct ScalingPoint {
  std::string machine;
  processors::machine::Scheme scheme = processors::machine::Scheme::image;
  std::uint32_t nodes = 0;
  sim::Ticks end = 0;
  sim::Ticks one_node_end = 0;
  std::optional<double> speed_up;
  std::optional<double> efficiency;
  figures::Limit limit = figures::Limit::nothing;
  std::optional<double> interconnect;  ///< its utilisation
  std::optional<double> hit_ratio;
  double idle = 0.0;     ///< share of the nodes' time
  double waiting = 0.0;  ///< share of the nodes' time spent waiting for anything but the end
  std::optional<figures::Count> messages;
  std::optional<figures::Count> message_bytes;
};

/// How many machines time_machines() times: of each file also that with one node.
[[nodiscard]] std::size_t machines_to_time(const SchemesConfig& config);

/// Times every machine with every number of nodes from the log; points in the order of the machines, then of
/// the nodes. A number that a machine cannot have (a pipeline needs a node for each stage) has no point. A
/// pipeline's nodes are shared out as in the quickest of `stages`, if there is any.
[[nodiscard]] std::vector<ScalingPoint> time_machines(const SchemesConfig& config,
                                                      const processors::program::WorkLog& log,
                                                      std::span<const StagePoint> stages);

/// "schemes": a row for each point.
[[nodiscard]] tables::Table scaling_table(std::span<const ScalingPoint> points);

/// The points of one machine.
[[nodiscard]] std::vector<ScalingPoint> points_of(std::span<const ScalingPoint> points,
                                                  std::string_view machine);

}  // namespace marti::studies::schemes
