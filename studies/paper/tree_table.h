// Table 1 of the paper: how many nodes an octree and a BSP tree have for the same scene, the same number of
// triangles in a leaf and the same smallest cell.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "memory/layout.h"
#include "scenes/scene.h"
#include "studies/paper/level_counts.h"
#include "studies/tables/table.h"

namespace marti::studies::paper {

struct TreeSize {
  std::vector<LevelCount> levels;
  std::uint64_t empty_leaves = 0;
  double build_seconds = 0.0;  ///< on the host

  [[nodiscard]] LevelCount total() const;
};

/// Both trees of one scene.
struct SceneTrees {
  std::string scene;
  std::uint64_t hash = 0;  ///< scene_hash
  std::uint64_t polygons = 0;
  std::uint64_t primitives = 0;  ///< triangles and quadrics
  TreeSize octree;
  TreeSize bsp;
};

/// Builds both. `name` is what the user calls the scene.
[[nodiscard]] SceneTrees measure_trees(const std::string& name, const scenes::Scene& scene,
                                       const accel::StructureOptions& options);

/// "table1": a row for each tree. "host_table1": the seconds it took to build.
[[nodiscard]] tables::Table tree_table(std::span<const SceneTrees> scenes,
                                       const memory::LayoutConfig& layout);
[[nodiscard]] tables::Table host_tree_table(std::span<const SceneTrees> scenes);

/// "rules": leaves against other nodes, level by level, of each octree.
[[nodiscard]] tables::Table rule_table(std::span<const SceneTrees> scenes);
/// "rule_levels": the first level at which each rule stops.
[[nodiscard]] tables::Table rule_level_table(std::span<const SceneTrees> scenes,
                                             std::span<const double> rules);

}  // namespace marti::studies::paper
