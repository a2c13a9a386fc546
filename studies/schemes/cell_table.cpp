#include "studies/schemes/cell_table.h"

namespace marti::studies::schemes {

std::vector<CellPoint> time_cells(const SchemesConfig& config) {
  std::vector<CellPoint> points;
  for (const std::uint32_t level : config.cell_levels) {
    keys::FrameConfig frame = config.frame;
    frame.structure_options.octree.max_level = level;
    frame.structure_options.octree.max_objects = config.cell_objects;
    points.push_back({level, time_tree(frame, config.cell_machine)});
  }
  return points;
}

tables::Table cell_table(std::span<const CellPoint> points) {
  tables::Table table("cells", "Cells: what their size does to the caches",
                      tree_columns(tables::count_column("level", "deepest level of the tree (root: 1)")));
  for (const CellPoint& point : points) {
    table.add_row(tree_cells(point.level, point.tree));
  }
  return table;
}

}  // namespace marti::studies::schemes
