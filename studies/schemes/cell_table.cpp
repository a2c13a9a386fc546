#include "studies/schemes/cell_table.h"

namespace marti::studies {

std::vector<CellPoint> time_cells(const SchemesConfig& config) {
  std::vector<CellPoint> points;
  for (const std::uint32_t level : config.cell_levels) {
    FrameConfig frame = config.frame;
    frame.structure_options.octree.max_level = level;
    frame.structure_options.octree.max_objects = config.cell_objects;
    points.push_back({level, time_tree(frame, config.cell_machine)});
  }
  return points;
}

Table cell_table(std::span<const CellPoint> points) {
  Table table("cells", "Cells: what their size does to the caches",
              tree_columns({"level", ColumnType::integer, "1", "deepest level of the tree (root: 1)"}));
  for (const CellPoint& point : points) {
    table.add_row(tree_cells(count_cell(point.level), point.tree));
  }
  return table;
}

}  // namespace marti::studies
