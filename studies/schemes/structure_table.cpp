#include "studies/schemes/structure_table.h"

namespace marti::studies::schemes {

std::vector<StructurePoint> time_structures(const SchemesConfig& config) {
  std::vector<StructurePoint> points;
  for (const NamedStructure& structure : config.structures) {
    keys::FrameConfig frame = config.frame;
    frame.structure = structure.kind;
    frame.structure_options.bvh.node = structure.node;
    points.push_back({structure.name, time_tree(frame, config.cell_machine)});
  }
  return points;
}

tables::Table structure_table(std::span<const StructurePoint> points) {
  tables::Table table("structures", "Structures: the same frame and machine with each",
                      tree_columns(tables::text_column("structure", "the structure")));
  for (const StructurePoint& point : points) {
    table.add_row(tree_cells(point.name, point.tree));
  }
  return table;
}

}  // namespace marti::studies::schemes
