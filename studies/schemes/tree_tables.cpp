#include "studies/schemes/tree_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "processors/replay/replay.h"
#include "sim/finished_parts.h"
#include "sim/statistics.h"
#include "studies/figures/derived_figures.h"
#include "studies/figures/flow_figures.h"
#include "studies/run/functional_run.h"

namespace marti::studies::schemes {

TreePoint time_tree(const keys::FrameConfig& frame, const std::filesystem::path& machine_file,
                    const std::string& name) {
  const NamedMachine machine = read_machine_file(machine_file, frame);
  TreePoint point;
  sim::once(
      frame.meter, "trees", name,
      [&] {
        const run::FunctionalRun run = run::run_functional(frame);
        const processors::program::WorkLog& log = *run.frame.log;
        const processors::replay::MachineResult result = processors::replay::replay(log, machine.config);
        point = {log.topology.nodes.size(), log.topology.entries.size(),
                 result.database_bytes,     result.steps(),
                 result.references(),       result.end};
      },
      point);
  return point;
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

std::vector<CellPoint> time_cells(const SchemesConfig& config) {
  std::vector<CellPoint> points;
  for (const std::uint32_t level : config.cell_levels) {
    keys::FrameConfig frame = config.frame;
    frame.structure_options.octree.max_level = level;
    frame.structure_options.octree.max_objects = config.cell_objects;
    points.push_back({level, time_tree(frame, config.cell_machine, "level " + std::to_string(level))});
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

std::vector<StructurePoint> time_structures(const SchemesConfig& config) {
  std::vector<StructurePoint> points;
  for (const NamedStructure& structure : config.structures) {
    keys::FrameConfig frame = config.frame;
    frame.structure = structure.kind;
    frame.structure_options.bvh.node = structure.node;
    points.push_back({structure.name, time_tree(frame, config.cell_machine, structure.name)});
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

namespace {

using Shares = std::array<std::uint32_t, pipeline_stages>;

StagePoint time_shares(const SchemesConfig& config, const processors::program::WorkLog& log,
                       const Shares& nodes) {
  processors::machine::PipelineConfig shares;
  shares.search = nodes[0];
  shares.nearest = nodes[1];
  shares.shade = nodes[2];
  const NamedMachine machine =
      read_machine_file(config.stage_machine, config.frame, config.stage_nodes, shares);
  StagePoint point;
  sim::begin_part(config.frame.meter, "balancing the stages of the pipeline");
  sim::once(
      config.frame.meter, "stages", fmt::format("{}", fmt::join(nodes, " ")),
      [&] {
        const processors::replay::MachineResult result = processors::replay::replay(log, machine.config);
        point.nodes = nodes;
        point.end = result.end;
        const figures::FlowFigures figures = figures::flow_figures(machine.config, result);
        for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
          point.busy[stage] = figures.stages[stage].busy;
        }
      },
      point);
  return point;
}

}  // namespace

std::size_t StagePoint::slowest() const {
  return static_cast<std::size_t>(std::ranges::max_element(busy) - busy.begin());
}

std::vector<StagePoint> time_stages(const SchemesConfig& config, const processors::program::WorkLog& log) {
  std::vector<StagePoint> points;
  if (config.stage_machine.empty()) {
    return points;
  }
  Shares nodes;
  nodes.fill(config.stage_nodes / pipeline_stages);
  nodes[0] += config.stage_nodes % pipeline_stages;
  std::set<Shares> tried;
  while (tried.insert(nodes).second) {
    points.push_back(time_shares(config, log, nodes));
    const StagePoint& point = points.back();
    const std::size_t slowest = point.slowest();
    std::size_t giver = pipeline_stages;
    for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
      if (stage != slowest && nodes[stage] > 1 &&
          (giver == pipeline_stages || point.busy[stage] < point.busy[giver])) {
        giver = stage;
      }
    }
    if (giver == pipeline_stages) {
      break;
    }
    --nodes[giver];
    ++nodes[slowest];
  }
  return points;
}

tables::Table stage_table(std::span<const StagePoint> points) {
  tables::Table table(
      "stages", "Stages: a pipeline's nodes shared out in several ways",
      {tables::count_column("step", "number of the way of sharing out"),
       tables::text_column("shares", "nodes that search, intersect and shade"),
       tables::text_column("stage", "one of the stages"), tables::count_column("nodes", "its nodes"),
       tables::real_column("busy", "fraction", "share of its nodes' time in which they worked"),
       tables::integer_column("end", "ps", "time of the frame")});
  for (std::size_t step = 0; step < points.size(); ++step) {
    const StagePoint& point = points[step];
    const std::string shares = std::to_string(point.nodes[0]) + " + " + std::to_string(point.nodes[1]) +
                               " + " + std::to_string(point.nodes[2]);
    for (std::size_t stage = 0; stage < pipeline_stages; ++stage) {
      table.add_row({step + 1, shares, stage_names[stage], point.nodes[stage], point.busy[stage], point.end});
    }
  }
  return table;
}

}  // namespace marti::studies::schemes
