#include "studies/schemes/tree_point.h"

#include <utility>

#include "processors/replay/replay.h"
#include "sim/statistics.h"
#include "studies/figures/derived_figures.h"
#include "studies/run/functional_run.h"

namespace marti::studies::schemes {

TreePoint time_tree(const keys::FrameConfig& frame, const std::filesystem::path& machine_file) {
  const NamedMachine machine = read_machine_file(machine_file, frame);
  const run::FunctionalRun run = run::run_functional(frame);
  const processors::program::WorkLog& log = *run.frame.log;
  const processors::replay::MachineResult result = processors::replay::replay(log, machine.config);
  return {log.topology.nodes.size(), log.topology.entries.size(),
          result.database_bytes,     result.steps(),
          result.references(),       result.end};
}

tables::Column figure_column(std::string_view figure) {
  const figures::FigureEntry& entry = figures::figure_named(figure);
  return {entry.name, entry.formula ? tables::ColumnType::real : tables::ColumnType::integer, entry.unit,
          entry.description};
}

std::vector<tables::Column> tree_columns(tables::Column first) {
  return {std::move(first),
          tables::count_column("tree_nodes", "nodes of the tree"),
          tables::count_column("tree_entries", "object references in its leaves"),
          figure_column("database_bytes"),
          tables::count_column("visits", "nodes visited"),
          tables::count_column("tests", "primitives tested"),
          tables::count_column("references", "lines referred to"),
          figure_column("misses"),
          figure_column("hit_ratio"),
          figure_column("end")};
}

std::vector<tables::Cell> tree_cells(tables::Cell first, const TreePoint& point) {
  return {std::move(first),
          point.tree_nodes,
          point.tree_entries,
          point.database_bytes,
          point.steps.branches + point.steps.leaves,
          point.steps.tests,
          point.references.references(),
          point.references.all_misses(),
          sim::ratio(point.references.all_hits(), point.references.references()),
          point.end};
}

}  // namespace marti::studies::schemes
