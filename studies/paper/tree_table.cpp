#include "studies/paper/tree_table.h"

#include <chrono>
#include <memory>

#include "studies/run/scene_hash.h"

namespace marti::studies {

namespace {

TreeSize measure(std::string_view kind, const std::shared_ptr<const accel::TriangleSet>& triangles,
                 const accel::StructureOptions& options) {
  TreeSize size;
  const auto begin = std::chrono::steady_clock::now();
  const std::unique_ptr<accel::Structure> structure = accel::make_structure(kind, triangles, options);
  size.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  size.levels = count_levels(structure->topology());
  for (const accel::TopologyNode& node : structure->topology().nodes) {
    size.empty_leaves += node.leaf && node.count == 0 ? 1U : 0U;
  }
  return size;
}

double quotient(std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); }

}  // namespace

LevelCount TreeSize::total() const {
  LevelCount sum;
  for (const LevelCount& level : levels) {
    sum.branches += level.branches;
    sum.leaves += level.leaves;
    sum.partial += level.partial;
    sum.leaf_entries += level.leaf_entries;
    sum.partial_entries += level.partial_entries;
  }
  return sum;
}

SceneTrees measure_trees(const std::string& name, const scenes::Scene& scene,
                         const accel::StructureOptions& options) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  SceneTrees trees;
  trees.scene = name;
  trees.hash = scene_hash(scene);
  trees.polygons = scene.polygons;
  trees.primitives = triangles->size();
  trees.octree = measure("octree", triangles, options);
  trees.bsp = measure("bsp", triangles, options);
  return trees;
}

Table tree_table(std::span<const SceneTrees> scenes, const memory::LayoutConfig& layout) {
  Table table("table1", "Table 1: octree and BSP tree of each scene",
              {{"scene", ColumnType::text, "", "scene"},
               {"polygons", ColumnType::integer, "1", "polygons of the scene's source"},
               {"primitives", ColumnType::integer, "1", "triangles they are cut into, and curved primitives"},
               {"structure", ColumnType::text, "", "octree or bsp"},
               {"nodes", ColumnType::integer, "1", "nodes of the whole tree"},
               {"branches", ColumnType::integer, "1", "nodes that were divided"},
               {"leaves", ColumnType::integer, "1", "nodes that were not, empty ones included"},
               {"empty_leaves", ColumnType::integer, "1", "leaves without triangles"},
               {"entries", ColumnType::integer, "1", "triangles listed in all leaves"},
               {"levels", ColumnType::integer, "1", "levels, the root's included"},
               {"bytes", ColumnType::integer, "byte", "node records and lists in the simulated database"},
               {"nodes_to_octree", ColumnType::real, "", "nodes as a multiple of the octree's"},
               {"bytes_to_octree", ColumnType::real, "", "bytes as a multiple of the octree's"}});
  for (const SceneTrees& scene : scenes) {
    const std::uint64_t octree_nodes = scene.octree.total().nodes();
    const std::uint64_t octree_bytes = bytes_of(scene.octree.levels, layout);
    for (const bool octree : {true, false}) {
      const TreeSize& size = octree ? scene.octree : scene.bsp;
      const LevelCount total = size.total();
      const std::uint64_t bytes = bytes_of(size.levels, layout);
      table.add_row({scene.scene, count_cell(scene.polygons), count_cell(scene.primitives),
                     octree ? "octree" : "bsp", count_cell(total.nodes()), count_cell(total.branches),
                     count_cell(total.leaves), count_cell(size.empty_leaves), count_cell(total.leaf_entries),
                     count_cell(size.levels.size()), count_cell(bytes), quotient(total.nodes(), octree_nodes),
                     quotient(bytes, octree_bytes)});
    }
  }
  return table;
}

Table host_tree_table(std::span<const SceneTrees> scenes) {
  Table table("host_table1", "Table 1 on the host: building the whole tree",
              {{"scene", ColumnType::text, "", "scene"},
               {"primitives", ColumnType::integer, "1", "triangles and curved primitives"},
               {"octree_seconds", ColumnType::real, "s", "building the octree, on all host threads"},
               {"bsp_seconds", ColumnType::real, "s", "building the BSP tree, on one"}});
  for (const SceneTrees& scene : scenes) {
    table.add_row(
        {scene.scene, count_cell(scene.primitives), scene.octree.build_seconds, scene.bsp.build_seconds});
  }
  return table;
}

Table rule_table(std::span<const SceneTrees> scenes) {
  Table table("rules", "Leaves against other nodes, level by level, in the octrees",
              {{"scene", ColumnType::text, "", "scene"},
               {"level", ColumnType::integer, "1", "level, the root's being 1"},
               {"leaves", ColumnType::integer, "1", "L: leaves of the level"},
               {"others", ColumnType::integer, "1",
                "B + P: nodes of the level that are to be divided, whether they have been or not"},
               {"ratio", ColumnType::real, "", "L / (B + P); infinite where all nodes are leaves"}});
  for (const SceneTrees& scene : scenes) {
    for (std::size_t i = 0; i < scene.octree.levels.size(); ++i) {
      const LevelCount& level = scene.octree.levels[i];
      table.add_row({scene.scene, count_cell(i + 1), count_cell(level.leaves),
                     count_cell(level.branches + level.partial), level.leaf_ratio().value_or(0.0)});
    }
  }
  return table;
}

Table rule_level_table(std::span<const SceneTrees> scenes, std::span<const double> rules) {
  Table table("rule_levels", "Where the rules stop: the first level with L > k (B + P)",
              {{"scene", ColumnType::text, "", "scene"},
               {"k", ColumnType::real, "", "the rule's factor"},
               {"level", ColumnType::integer, "1", "first such level; no value: there is none"},
               {"levels", ColumnType::integer, "1", "levels of the whole octree"}});
  for (const SceneTrees& scene : scenes) {
    for (const double k : rules) {
      const std::optional<std::uint32_t> level = rule_level(scene.octree.levels, k);
      table.add_row(
          {scene.scene, k, level ? count_cell(*level) : Cell(), count_cell(scene.octree.levels.size())});
    }
  }
  return table;
}

}  // namespace marti::studies
