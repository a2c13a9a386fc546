// A pipeline's nodes shared out among its stages in several ways: which stage decides.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "processors/flow/pipeline/stages.h"
#include "processors/program/work_log.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/tables/table.h"

namespace marti::studies::schemes {

using processors::flow::stage_names;
using processors::machine::pipeline_stages;

struct StagePoint {
  std::array<std::uint32_t, pipeline_stages> nodes{};
  /// Time the nodes of each stage worked or waited for memory, over that of all nodes of the stage.
  std::array<double, pipeline_stages> busy{};
  sim::Ticks end = 0;

  [[nodiscard]] std::size_t slowest() const;
};

/// Starts with shares that are as equal as can be, then takes a node from the stage that is least busy and
/// gives it to the one that is busiest, until a way of sharing out comes up again.
[[nodiscard]] std::vector<StagePoint> time_stages(const SchemesConfig& config,
                                                  const processors::program::WorkLog& log);

/// "stages": a row for each stage of each way of sharing out.
[[nodiscard]] tables::Table stage_table(std::span<const StagePoint> points);

}  // namespace marti::studies::schemes
