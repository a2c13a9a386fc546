// Frames with other trees: the cells of a grid, the structures, and how few nodes each stage of a pipeline
// takes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "processors/cost/accounting.h"
#include "processors/flow/pipeline/stages.h"
#include "processors/program/work_log.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/tables/table.h"

namespace marti::studies::schemes {

struct TreePoint {
  std::uint64_t tree_nodes = 0;
  std::uint64_t tree_entries = 0;
  std::uint64_t database_bytes = 0;
  processors::cost::StepCounts steps;
  processors::cost::ReferenceCounts references;
  sim::Ticks end = 0;
};

/// Traces the frame and times the machine of the file on it, once (sim/finished_parts.h) for each `name`.
[[nodiscard]] TreePoint time_tree(const keys::FrameConfig& frame, const std::filesystem::path& machine_file,
                                  const std::string& name);

/// The column of a figure of the catalogue (studies/figures), with its name, unit and description.
[[nodiscard]] tables::Column figure_column(std::string_view figure);

/// `first`, then the columns of a TreePoint.
[[nodiscard]] std::vector<tables::Column> tree_columns(tables::Column first);

/// `first`, then the cells of a TreePoint.
[[nodiscard]] std::vector<tables::Cell> tree_cells(tables::Cell first, const TreePoint& point);

struct CellPoint {
  std::uint32_t level = 0;  ///< structure.max_level
  TreePoint tree;
};

[[nodiscard]] std::vector<CellPoint> time_cells(const SchemesConfig& config);

/// "cells": a row for each level.
[[nodiscard]] tables::Table cell_table(std::span<const CellPoint> points);

struct StructurePoint {
  std::string name;  ///< as in schemes.structures
  TreePoint tree;
};

[[nodiscard]] std::vector<StructurePoint> time_structures(const SchemesConfig& config);

/// "structures": a row for each.
[[nodiscard]] tables::Table structure_table(std::span<const StructurePoint> points);

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
