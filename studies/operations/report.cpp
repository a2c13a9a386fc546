// The tables of `marti study operations`.
#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string_view>

#include "studies/operations/operations.h"

namespace marti::studies::operations {

namespace {

using processors::cost::OperationMix;
using Lines = std::back_insert_iterator<std::string>;

constexpr std::size_t operation_kinds = 6;
constexpr std::array<std::string_view, operation_kinds> operation_names = {
    "add", "multiply", "divide", "square_root", "compare", "integer"};

using Operations = std::array<double, operation_kinds>;

Operations of(const OperationMix& mix) {
  const auto each = [](std::int64_t thousandths) { return static_cast<double>(thousandths) * 1e-3; };
  return {each(mix.add),         each(mix.multiply), each(mix.divide),
          each(mix.square_root), each(mix.compare),  each(mix.integer)};
}

/// One kind of step: how many a ray takes, and what each takes.
struct StepRow {
  std::string_view name;
  double per_ray;
  Operations operations;
};

/// Setting up, branch, leaf, look-up, tests by kind, and what a ray takes without and with its tests.
std::vector<StepRow> steps_of(const WalkRow& row) {
  const processors::program::LogTotals& steps = row.measured.steps;
  const processors::cost::OperationMixes& mixes = row.measured.mixes;
  const auto rays = static_cast<double>(steps.all_rays());
  const auto per_ray = [rays](std::uint64_t count) { return static_cast<double>(count) / rays; };
  Operations set_up{};
  for (std::size_t kind = 0; kind < processors::program::ray_kinds; ++kind) {
    const Operations one = of(mixes.ray[kind]);
    for (std::size_t i = 0; i < operation_kinds; ++i) {
      set_up[i] += one[i] * per_ray(steps.rays[kind]);
    }
  }
  std::vector<StepRow> rows = {{"ray", 1.0, set_up},
                               {"branch", per_ray(steps.branches), of(mixes.branch)},
                               {"leaf", per_ray(steps.leaves), of(mixes.leaf)},
                               {"lookup", per_ray(steps.lookups), of(mixes.lookup)},
                               {"test", per_ray(row.measured.tests[0]), of(mixes.test)},
                               {"sphere_test", per_ray(row.measured.tests[1]), of(mixes.sphere_test)},
                               {"cone_test", per_ray(row.measured.tests[2]), of(mixes.cone_test)}};
  Operations walk{};
  Operations all{};
  for (const StepRow& step : rows) {
    for (std::size_t i = 0; i < operation_kinds; ++i) {
      const double part = step.per_ray * step.operations[i];
      all[i] += part;
      walk[i] += step.name == "branch" || step.name == "leaf" ? part : 0.0;
    }
  }
  rows.push_back({"walk", 1.0, walk});
  rows.push_back({"all", 1.0, all});
  return rows;
}

std::string full_name(const WalkRow& row) { return row.name + (row.mailboxes ? ", mailboxes" : ""); }

void walk_lines(Lines out, const OperationsStudy& study) {
  fmt::format_to(out,
                 "operations counted: {}, depth of rays {}, max_objects {}, max_level {}\n\n"
                 "{:<33}{:>6}{:>10}{:>10} |{:>10}{:>9}{:>9}{:>10}   a ray\n",
                 study.scene, study.max_depth, study.max_objects, study.max_level, "walk", "side", "nodes",
                 "entries", "branches", "leaves", "lookups", "tests");
  for (const WalkRow& row : study.walks) {
    const processors::program::LogTotals& steps = row.measured.steps;
    const auto per_ray = [&](std::uint64_t count) {
      return static_cast<double>(count) / static_cast<double>(steps.all_rays());
    };
    fmt::format_to(out, "{:<33}{:>6}{:>10}{:>10} |{:>10.2f}{:>9.2f}{:>9.2f}{:>10.2f}\n", full_name(row),
                   row.side, row.nodes, row.entries, per_ray(steps.branches), per_ray(steps.leaves),
                   per_ray(steps.lookups), per_ray(steps.tests));
  }
}

void step_lines(Lines out, const OperationsStudy& study) {
  fmt::format_to(out, "\n{:<33}{:<12}{:>9} |", "walk", "step", "a ray");
  for (const std::string_view name : operation_names) {
    fmt::format_to(out, "{:>12}", name);
  }
  fmt::format_to(out, "   a step\n");
  for (const WalkRow& row : study.walks) {
    if (row.mailboxes) {
      continue;  // its steps take the operations of those without mailboxes, and one integer operation a
                 // look-up
    }
    for (const StepRow& step : steps_of(row)) {
      if (step.per_ray == 0.0) {
        continue;
      }
      fmt::format_to(out, "{:<33}{:<12}{:>9.2f} |", row.name, step.name, step.per_ray);
      for (const double count : step.operations) {
        fmt::format_to(out, "{:>12.3f}", count);
      }
      fmt::format_to(out, "\n");
    }
  }
  fmt::format_to(out,
                 "\"walk\" is all branches and leaves of a ray, \"all\" its set-up and tests too\n\n"
                 "the paper, a step:\n"
                 "  octree (HERO), branch      3 additions, 3 divisions, 1 exclusive or\n"
                 "  grid, cell                 2 additions, 2 comparisons\n"
                 "  bsp, push-point, leaf      7 additions, 6 divisions, 5 comparisons\n");
}

/// Nodes per unit length of a full octree: the sum over its levels of 1.5 / 2^(depth - level).
double predicted_full(const UnitLengthRow& row) { return 3.0 - 1.5 / row.width; }

void length_lines(Lines out, const OperationsStudy& study) {
  fmt::format_to(out,
                 "\nper unit length, the width of the finest cell; isotropic rays through the cube\n"
                 "{:>5}{:>7} |{:>8}{:>9} |{:>9}{:>9}{:>9}{:>9} |{:>9}{:>9}{:>11}{:>9} |{:>11}\n",
                 "depth", "width", "grid", "add+cmp", "octree", "branch", "full", "add+cmp", "surface",
                 "leaves", "d/2^(d-1)", "add+cmp", "surf/grid");
  for (const UnitLengthRow& row : study.lengths) {
    const auto unit = [&](std::uint64_t count) { return static_cast<double>(count) / row.length; };
    const auto floating = [&](const accel::OperationCounts& c) { return unit(c.add + c.compare); };
    fmt::format_to(out,
                   "{:>5}{:>7} |{:>8.3f}{:>9.3f} |{:>9.3f}{:>9.3f}{:>9.3f}{:>9.3f} |{:>9.3f}{:>9.3f}{:>11.3f}"
                   "{:>9.3f} |{:>11.3f}\n",
                   row.depth, row.width, unit(row.cells), floating(row.grid),
                   unit(row.full_branches + row.full_leaves), unit(row.full_branches), predicted_full(row),
                   floating(row.full), unit(row.surface_branches + row.surface_leaves),
                   unit(row.surface_leaves), static_cast<double>(row.depth) / row.width,
                   floating(row.surface),
                   static_cast<double>(row.surface.add + row.surface.compare) /
                       static_cast<double>(row.grid.add + row.grid.compare));
  }
  fmt::format_to(
      out,
      "grid: cells; predicted 1.5, with 3 additions and 3 comparisons\n"
      "octree: nodes of an octree full to the depth; predicted (column full) the sum over its levels\n"
      "of 1.5 / 2^(depth - level), which tends to 3, half of them branches\n"
      "surface: nodes of an octree that reaches the depth along a sphere; leaves predicted d/2^(d-1)\n"
      "add+cmp: floating-point additions and comparisons counted; multiplications are in the table\n");
}

std::string text_of(const OperationsStudy& study) {
  std::string text;
  const Lines out = std::back_inserter(text);
  walk_lines(out, study);
  step_lines(out, study);
  length_lines(out, study);
  return text;
}

void add_operation_columns(std::vector<tables::Column>& columns, std::string_view of_what) {
  for (const std::string_view name : operation_names) {
    columns.push_back(
        tables::real_column(name, "1",
                            std::string(name == "integer" ? "integer and logic operations" : name) + ", " +
                                std::string(of_what)));
  }
}

tables::Table step_table(const OperationsStudy& study) {
  std::vector<tables::Column> columns = {
      tables::text_column("walk", "structure and walk"),
      tables::count_column("mailboxes", "1 with mailboxes, else 0"),
      tables::count_column("nodes", "nodes of the structure"),
      tables::count_column("entries", "primitives listed in its leaves"),
      tables::text_column("step", "kind of step; walk: all branches and leaves of a ray; all: the whole ray"),
      tables::real_column("steps_per_ray", "1", "steps of the kind that a ray takes, on average")};
  add_operation_columns(columns, "on average, of one step");
  tables::Table table("operations", "Operations of each walk", std::move(columns));
  for (const WalkRow& row : study.walks) {
    for (const StepRow& step : steps_of(row)) {
      std::vector<tables::Cell> cells = {row.name,    row.mailboxes, row.nodes,
                                         row.entries, step.name,     step.per_ray};
      cells.insert(cells.end(), step.operations.begin(), step.operations.end());
      table.add_row(std::move(cells));
    }
  }
  return table;
}

tables::Table length_table(const OperationsStudy& study) {
  std::vector<tables::Column> columns = {
      tables::count_column("depth", "levels of the octree"),
      tables::count_column("width", "finest cells along an axis"),
      tables::text_column("structure", "what the rays walk through"),
      tables::real_column("predicted_nodes", "1",
                          "nodes per unit length by the argument; none for a surface"),
      tables::real_column("nodes", "1", "nodes visited per unit length, the width of the finest cell"),
      tables::real_column("branches", "1", "of these, branches"),
      tables::real_column("leaves", "1", "of these, leaves")};
  add_operation_columns(columns, "of the walk per unit length");
  tables::Table table("unit_length", "Operations per unit length of a ray", std::move(columns));
  for (const UnitLengthRow& row : study.lengths) {
    const auto unit = [&](std::uint64_t count) { return static_cast<double>(count) / row.length; };
    const auto line = [&](const char* name, const tables::Cell& predicted, std::uint64_t branches,
                          std::uint64_t leaves, const accel::OperationCounts& c) {
      table.add_row({row.depth, row.width, name, predicted, unit(branches + leaves), unit(branches),
                     unit(leaves), unit(c.add), unit(c.multiply), unit(c.divide), unit(c.square_root),
                     unit(c.compare), unit(c.integer)});
    };
    line("grid", 1.5, 0, row.cells, row.grid);
    line("full octree", predicted_full(row), row.full_branches, row.full_leaves, row.full);
    line("surface octree", {}, row.surface_branches, row.surface_leaves, row.surface);
  }
  return table;
}

}  // namespace

tables::StudyOutput output_of(const OperationsStudy& study) {
  tables::StudyOutput output;
  output.tables = {step_table(study), length_table(study)};
  output.report = text_of(study);
  return output;
}

}  // namespace marti::studies::operations
