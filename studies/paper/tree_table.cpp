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
      {tables::text_column("scene", "scene"),
       tables::count_column("polygons", "polygons of the scene's source"),
       tables::count_column("primitives", "triangles they are cut into, and curved primitives"),
       tables::text_column("structure", "octree or bsp"),
       tables::count_column("nodes", "nodes of the whole tree"),
       tables::count_column("branches", "nodes that were divided"),
       tables::count_column("leaves", "nodes that were not, empty ones included"),
       tables::count_column("empty_leaves", "leaves without triangles"),
       tables::count_column("entries", "triangles listed in all leaves"),
       tables::count_column("levels", "levels, the root's included"),
       tables::integer_column("bytes", "byte", "node records and lists in the simulated database"),
       tables::real_column("nodes_to_octree", "", "nodes as a multiple of the octree's"),
       tables::real_column("bytes_to_octree", "", "bytes as a multiple of the octree's")});
  for (const SceneTrees& scene : scenes) {
    const std::uint64_t octree_nodes = scene.octree.total().nodes();
    const std::uint64_t octree_bytes = bytes_of(scene.octree.levels, layout);
    for (const bool octree : {true, false}) {
      const TreeSize& size = octree ? scene.octree : scene.bsp;
      const LevelCount total = size.total();
      const std::uint64_t bytes = bytes_of(size.levels, layout);
      table.add_row({scene.scene, scene.polygons, scene.primitives, octree ? "octree" : "bsp", total.nodes(),
                     total.branches, total.leaves, size.empty_leaves, total.leaf_entries, size.levels.size(),
                     bytes, quotient(total.nodes(), octree_nodes), quotient(bytes, octree_bytes)});
    }
  }
  return table;
}

tables::Table host_tree_table(std::span<const SceneTrees> scenes) {
  tables::Table table("host_table1", "Table 1 on the host: building the whole tree",
                      {tables::text_column("scene", "scene"),
                       tables::count_column("primitives", "triangles and curved primitives"),
                       tables::real_column("octree_seconds", "s", "building the octree, on all host threads"),
                       tables::real_column("bsp_seconds", "s", "building the BSP tree, on one")});
  for (const SceneTrees& scene : scenes) {
    table.add_row({scene.scene, scene.primitives, scene.octree.build_seconds, scene.bsp.build_seconds});
  }
  return table;
}

tables::Table rule_table(std::span<const SceneTrees> scenes) {
  tables::Table table(
      "rules", "Leaves against other nodes, level by level, in the octrees",
      {tables::text_column("scene", "scene"), tables::count_column("level", "level, the root's being 1"),
       tables::count_column("leaves", "L: leaves of the level"),
       tables::count_column(
           "others", "B + P: nodes of the level that are to be divided, whether they have been or not"),
       tables::real_column("ratio", "", "L / (B + P); infinite where all nodes are leaves")});
  for (const SceneTrees& scene : scenes) {
    for (std::size_t i = 0; i < scene.octree.levels.size(); ++i) {
      const LevelCount& level = scene.octree.levels[i];
      table.add_row({scene.scene, i + 1, level.leaves, level.branches + level.partial,
                     level.leaf_ratio().value_or(0.0)});
    }
  }
  return table;
}

tables::Table rule_level_table(std::span<const SceneTrees> scenes, std::span<const double> rules) {
  tables::Table table(
      "rule_levels", "Where the rules stop: the first level with L > k (B + P)",
      {tables::text_column("scene", "scene"), tables::real_column("k", "", "the rule's factor"),
       tables::count_column("level", "first such level; no value: there is none"),
       tables::count_column("levels", "levels of the whole octree")});
  for (const SceneTrees& scene : scenes) {
    for (const double k : rules) {
      const std::optional<std::uint32_t> level = rule_level(scene.octree.levels, k);
      table.add_row({scene.scene, k, level, scene.octree.levels.size()});
    }
  }
  return table;
}

}  // namespace marti::studies::paper
