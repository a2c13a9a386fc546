// What the size of the tree's cells does to the caches: one tree, one functional run and one machine for each
// deepest level.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "processors/cost/accounting.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/tables/table.h"

namespace marti::studies {

struct CellPoint {
  std::uint32_t level = 0;  ///< structure.max_level
  std::uint64_t tree_nodes = 0;
  std::uint64_t tree_entries = 0;
  std::uint64_t database_bytes = 0;
  processors::StepCounts steps;
  processors::ReferenceCounts references;
  sim::Ticks end = 0;
};

[[nodiscard]] std::vector<CellPoint> time_cells(const SchemesConfig& config);

/// "cells": a row for each level.
[[nodiscard]] Table cell_table(std::span<const CellPoint> points);

}  // namespace marti::studies
