// One tree, one functional run and one machine: what the tree costs the machine.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "processors/cost/accounting.h"
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

/// Traces the frame and times the machine of the file on it.
[[nodiscard]] TreePoint time_tree(const keys::FrameConfig& frame, const std::filesystem::path& machine_file);

/// The column of a figure of the catalogue (studies/figures), with its name, unit and description.
[[nodiscard]] tables::Column figure_column(std::string_view figure);

/// `first`, then the columns of a TreePoint.
[[nodiscard]] std::vector<tables::Column> tree_columns(tables::Column first);

/// `first`, then the cells of a TreePoint.
[[nodiscard]] std::vector<tables::Cell> tree_cells(tables::Cell first, const TreePoint& point);

}  // namespace marti::studies::schemes
