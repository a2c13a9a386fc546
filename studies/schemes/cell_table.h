// What the size of the tree's cells does to the caches: one tree, one functional run and one machine for each
// deepest level.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "studies/schemes/schemes_keys.h"
#include "studies/schemes/tree_point.h"
#include "studies/tables/table.h"

namespace marti::studies::schemes {

struct CellPoint {
  std::uint32_t level = 0;  ///< structure.max_level
  TreePoint tree;
};

[[nodiscard]] std::vector<CellPoint> time_cells(const SchemesConfig& config);

/// "cells": a row for each level.
[[nodiscard]] tables::Table cell_table(std::span<const CellPoint> points);

}  // namespace marti::studies::schemes
