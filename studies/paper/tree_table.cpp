#include "studies/paper/tree_table.h"

#include <chrono>
#include <memory>

#include "studies/run/scene_hash.h"

namespace marti::studies::paper {

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
  trees.hash = run::scene_hash(scene);
  trees.polygons = scene.polygons;
  trees.primitives = triangles->size();
  trees.octree = measure("octree", triangles, options);
  trees.bsp = measure("bsp", triangles, options);
  return trees;
}

tables::Table tree_table(std::span<const SceneTrees> scenes, const memory::LayoutConfig& layout) {
  tables::Table table(
      "table1", "Table 1: octree and BSP tree of each scene",
      {{"scene", tables::ColumnType::text, "", "scene"},
       {"polygons", tables::ColumnType::integer, "1", "polygons of the scene's source"},
       {"primitives", tables::ColumnType::integer, "1", "triangles they are cut into, and curved primitives"},
       {"structure", tables::ColumnType::text, "", "octree or bsp"},
       {"nodes", tables::ColumnType::integer, "1", "nodes of the whole tree"},
       {"branches", tables::ColumnType::integer, "1", "nodes that were divided"},
       {"leaves", tables::ColumnType::integer, "1", "nodes that were not, empty ones included"},
       {"empty_leaves", tables::ColumnType::integer, "1", "leaves without triangles"},
       {"entries", tables::ColumnType::integer, "1", "triangles listed in all leaves"},
       {"levels", tables::ColumnType::integer, "1", "levels, the root's included"},
       {"bytes", tables::ColumnType::integer, "byte", "node records and lists in the simulated database"},
       {"nodes_to_octree", tables::ColumnType::real, "", "nodes as a multiple of the octree's"},
       {"bytes_to_octree", tables::ColumnType::real, "", "bytes as a multiple of the octree's"}});
  for (const SceneTrees& scene : scenes) {
    const std::uint64_t octree_nodes = scene.octree.total().nodes();
    const std::uint64_t octree_bytes = bytes_of(scene.octree.levels, layout);
    for (const bool octree : {true, false}) {
      const TreeSize& size = octree ? scene.octree : scene.bsp;
      const LevelCount total = size.total();
      const std::uint64_t bytes = bytes_of(size.levels, layout);
      table.add_row({scene.scene, tables::count_cell(scene.polygons), tables::count_cell(scene.primitives),
                     octree ? "octree" : "bsp", tables::count_cell(total.nodes()),
                     tables::count_cell(total.branches), tables::count_cell(total.leaves),
                     tables::count_cell(size.empty_leaves), tables::count_cell(total.leaf_entries),
                     tables::count_cell(size.levels.size()), tables::count_cell(bytes),
                     quotient(total.nodes(), octree_nodes), quotient(bytes, octree_bytes)});
    }
  }
  return table;
}

tables::Table host_tree_table(std::span<const SceneTrees> scenes) {
  tables::Table table(
      "host_table1", "Table 1 on the host: building the whole tree",
      {{"scene", tables::ColumnType::text, "", "scene"},
       {"primitives", tables::ColumnType::integer, "1", "triangles and curved primitives"},
       {"octree_seconds", tables::ColumnType::real, "s", "building the octree, on all host threads"},
       {"bsp_seconds", tables::ColumnType::real, "s", "building the BSP tree, on one"}});
  for (const SceneTrees& scene : scenes) {
    table.add_row({scene.scene, tables::count_cell(scene.primitives), scene.octree.build_seconds,
                   scene.bsp.build_seconds});
  }
  return table;
}

tables::Table rule_table(std::span<const SceneTrees> scenes) {
  tables::Table table(
      "rules", "Leaves against other nodes, level by level, in the octrees",
      {{"scene", tables::ColumnType::text, "", "scene"},
       {"level", tables::ColumnType::integer, "1", "level, the root's being 1"},
       {"leaves", tables::ColumnType::integer, "1", "L: leaves of the level"},
       {"others", tables::ColumnType::integer, "1",
        "B + P: nodes of the level that are to be divided, whether they have been or not"},
       {"ratio", tables::ColumnType::real, "", "L / (B + P); infinite where all nodes are leaves"}});
  for (const SceneTrees& scene : scenes) {
    for (std::size_t i = 0; i < scene.octree.levels.size(); ++i) {
      const LevelCount& level = scene.octree.levels[i];
      table.add_row({scene.scene, tables::count_cell(i + 1), tables::count_cell(level.leaves),
                     tables::count_cell(level.branches + level.partial), level.leaf_ratio().value_or(0.0)});
    }
  }
  return table;
}

tables::Table rule_level_table(std::span<const SceneTrees> scenes, std::span<const double> rules) {
  tables::Table table(
      "rule_levels", "Where the rules stop: the first level with L > k (B + P)",
      {{"scene", tables::ColumnType::text, "", "scene"},
       {"k", tables::ColumnType::real, "", "the rule's factor"},
       {"level", tables::ColumnType::integer, "1", "first such level; no value: there is none"},
       {"levels", tables::ColumnType::integer, "1", "levels of the whole octree"}});
  for (const SceneTrees& scene : scenes) {
    for (const double k : rules) {
      const std::optional<std::uint32_t> level = rule_level(scene.octree.levels, k);
      table.add_row({scene.scene, k, level ? tables::count_cell(*level) : tables::Cell(),
                     tables::count_cell(scene.octree.levels.size())});
    }
  }
  return table;
}

}  // namespace marti::studies::paper
