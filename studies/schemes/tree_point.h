// One tree, one functional run and one machine: what the tree costs the machine.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "processors/cost/accounting.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/tables/table.h"

namespace marti::studies {

struct TreePoint {
  std::uint64_t tree_nodes = 0;
  std::uint64_t tree_entries = 0;
  std::uint64_t database_bytes = 0;
  processors::StepCounts steps;
  processors::ReferenceCounts references;
  sim::Ticks end = 0;
};

/// Traces the frame and times the machine of the file on it.
[[nodiscard]] TreePoint time_tree(const FrameConfig& frame, const std::filesystem::path& machine_file);

/// The column of a figure of the catalogue (studies/figures), with its name, unit and description.
[[nodiscard]] Column figure_column(std::string_view figure);

/// `first`, then the columns of a TreePoint.
[[nodiscard]] std::vector<Column> tree_columns(Column first);

/// `first`, then the cells of a TreePoint.
[[nodiscard]] std::vector<Cell> tree_cells(Cell first, const TreePoint& point);

}  // namespace marti::studies
