#include "studies/schemes/tree_point.h"

#include <optional>
#include <utility>

#include "processors/replay/replay.h"
#include "sim/statistics.h"
#include "studies/figures/derived_figures.h"
#include "studies/run/functional_run.h"

namespace marti::studies {

TreePoint time_tree(const FrameConfig& frame, const std::filesystem::path& machine_file) {
  const NamedMachine machine = read_machine_file(machine_file, frame);
  const FunctionalRun run = run_functional(frame);
  const processors::WorkLog& log = *run.frame.log;
  const processors::MachineResult result = processors::replay(log, machine.config);
  return {log.topology.nodes.size(), log.topology.entries.size(),
          result.database_bytes,     result.steps(),
          result.references(),       result.end};
}

Column figure_column(std::string_view figure) {
  const FigureEntry& entry = figure_named(figure);
  return {entry.name, entry.formula ? ColumnType::real : ColumnType::integer, entry.unit, entry.description};
}

std::vector<Column> tree_columns(Column first) {
  return {std::move(first),
          {"tree_nodes", ColumnType::integer, "1", "nodes of the tree"},
          {"tree_entries", ColumnType::integer, "1", "object references in its leaves"},
          figure_column("database_bytes"),
          {"visits", ColumnType::integer, "1", "nodes visited"},
          {"tests", ColumnType::integer, "1", "primitives tested"},
          {"references", ColumnType::integer, "1", "lines referred to"},
          figure_column("misses"),
          figure_column("hit_ratio"),
          figure_column("end")};
}

std::vector<Cell> tree_cells(Cell first, const TreePoint& point) {
  const std::optional<double> hits = sim::ratio(point.references.all_hits(), point.references.references());
  return {std::move(first),
          count_cell(point.tree_nodes),
          count_cell(point.tree_entries),
          count_cell(point.database_bytes),
          point.steps.branches + point.steps.leaves,
          point.steps.tests,
          point.references.references(),
          point.references.all_misses(),
          hits ? Cell(*hits) : Cell(),
          point.end};
}

}  // namespace marti::studies
