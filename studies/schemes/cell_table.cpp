#include "studies/schemes/cell_table.h"

#include "processors/replay/replay.h"
#include "sim/statistics.h"
#include "studies/run/functional_run.h"

namespace marti::studies {

std::vector<CellPoint> time_cells(const SchemesConfig& config) {
  const NamedMachine machine = read_machine_file(config.cell_machine);
  std::vector<CellPoint> points;
  for (const std::uint32_t level : config.cell_levels) {
    FrameConfig frame = config.frame;
    frame.structure_options.octree.max_level = level;
    frame.structure_options.octree.max_objects = config.cell_objects;
    const FunctionalRun run = run_functional(frame);
    const processors::WorkLog& log = *run.frame.log;
    const processors::MachineResult result = processors::replay(log, machine.config);
    points.push_back({level, log.topology.nodes.size(), log.topology.entries.size(), result.database_bytes,
                      result.steps(), result.references(), result.end});
  }
  return points;
}

Table cell_table(std::span<const CellPoint> points) {
  Table table("cells", "Cells: what their size does to the caches",
              {{"level", ColumnType::integer, "1", "deepest level of the tree (root: 1)"},
               {"tree_nodes", ColumnType::integer, "1", "nodes of the tree"},
               {"tree_entries", ColumnType::integer, "1", "object references in its leaves"},
               {"database", ColumnType::integer, "byte", "size of the database"},
               {"visits", ColumnType::integer, "1", "nodes visited"},
               {"tests", ColumnType::integer, "1", "primitives tested"},
               {"references", ColumnType::integer, "1", "lines referred to"},
               {"misses", ColumnType::integer, "1", "of these, misses"},
               {"hit_ratio", ColumnType::real, "fraction", "hits / references"},
               {"end", ColumnType::integer, "ps", "time of the frame"}});
  for (const CellPoint& point : points) {
    const std::optional<double> hits = sim::ratio(point.references.all_hits(), point.references.references());
    table.add_row({count_cell(point.level), count_cell(point.tree_nodes), count_cell(point.tree_entries),
                   count_cell(point.database_bytes), point.steps.branches + point.steps.leaves,
                   point.steps.tests, point.references.references(), point.references.all_misses(),
                   hits ? Cell(*hits) : Cell(), point.end});
  }
  return table;
}

}  // namespace marti::studies
