// Structures side by side on one machine: a functional run and a replay of each.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/schemes/schemes_keys.h"
#include "studies/schemes/tree_point.h"
#include "studies/tables/table.h"

namespace marti::studies::schemes {

struct StructurePoint {
  std::string name;  ///< as in schemes.structures
  TreePoint tree;
};

[[nodiscard]] std::vector<StructurePoint> time_structures(const SchemesConfig& config);

/// "structures": a row for each.
[[nodiscard]] tables::Table structure_table(std::span<const StructurePoint> points);

}  // namespace marti::studies::schemes
