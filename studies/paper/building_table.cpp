#include "studies/paper/building_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/error.h"

namespace marti::studies::paper {

namespace {

std::uint64_t ticks(sim::Ticks time) { return static_cast<std::uint64_t>(time); }

/// The additional time compared with that of the whole tree, as a fraction of the latter.
double change(sim::Ticks time, sim::Ticks whole) {
  return whole == 0 ? 0.0 : static_cast<double>(time - whole) / static_cast<double>(whole);
}

}  // namespace

std::string InitialLevel::note() const {
  std::string text = whole ? "whole tree" : "";
  for (const double k : rules) {
    text += (text.empty() ? "" : ", ") + fmt::format("k = {:g}", k);
  }
  return text;
}

std::vector<InitialLevel> initial_levels(const PaperConfig& config, std::span<const LevelCount> levels) {
  const auto deepest = static_cast<std::uint32_t>(levels.size());
  std::vector<InitialLevel> chosen;
  for (const std::uint32_t level : config.levels) {
    if (level < deepest) {
      chosen.push_back({level, false, {}});
    }
  }
  chosen.push_back({deepest, true, {}});
  for (const double k : config.rules) {
    const std::uint32_t level = rule_level(levels, k).value_or(deepest);
    auto at = std::find_if(chosen.begin(), chosen.end(), [level](const auto& c) { return c.level >= level; });
    if (at->level != level) {
      at = chosen.insert(at, {level, false, {}});
    }
    at->rules.push_back(k);
  }
  return chosen;
}

const LevelOutcome* RunOutcomes::by_rule(double k) const {
  for (const LevelOutcome& outcome : levels) {
    if (std::find(outcome.initial.rules.begin(), outcome.initial.rules.end(), k) !=
        outcome.initial.rules.end()) {
      return &outcome;
    }
  }
  return nullptr;
}

double saved(std::uint64_t value, std::uint64_t whole) {
  return whole == 0 ? 0.0
                    : (static_cast<double>(whole) - static_cast<double>(value)) / static_cast<double>(whole);
}

tables::Table building_table(std::size_t index, const RunOutcomes& outcomes) {
  tables::Table table(
      fmt::format("table{}", index + 2),
      fmt::format("Table {}: {}, the octree built to an initial level before the frame", index + 2,
                  name_of(outcomes.run)),
      {{"level", tables::ColumnType::integer, "1",
        "initial level: its nodes are not divided before the frame"},
       {"note", tables::ColumnType::text, "", "rules that choose the level"},
       {"build", tables::ColumnType::integer, "ps", "time until the initial tree is there"},
       {"render", tables::ColumnType::integer, "ps", "time from then on, building on demand included"},
       {"total", tables::ColumnType::integer, "ps", "both"},
       {"building", tables::ColumnType::integer, "ps",
        "compute time for building before the frame and in it, all nodes together"},
       {"splits", tables::ColumnType::integer, "1", "nodes divided before the frame and in it"},
       {"nodes", tables::ColumnType::integer, "1", "nodes that the frame leaves"},
       {"partial", tables::ColumnType::integer, "1", "of these, nodes left partially built"},
       {"memory", tables::ColumnType::integer, "byte", "records and lists that the frame leaves"},
       {"memory_saved", tables::ColumnType::real, "fraction", "memory saved against the whole tree"},
       {"building_saved", tables::ColumnType::real, "fraction", "compute time for building saved against it"},
       {"total_change", tables::ColumnType::real, "fraction", "total time against it"}});
  const LevelOutcome& whole = outcomes.whole();
  for (const LevelOutcome& outcome : outcomes.levels) {
    table.add_row({tables::count_cell(outcome.initial.level), outcome.initial.note(), outcome.build,
                   outcome.render, outcome.total(), outcome.building(), tables::count_cell(outcome.splits),
                   tables::count_cell(outcome.nodes), tables::count_cell(outcome.partial),
                   tables::count_cell(outcome.bytes), saved(outcome.bytes, whole.bytes),
                   saved(ticks(outcome.building()), ticks(whole.building())),
                   change(outcome.total(), whole.total())});
  }
  return table;
}

tables::Table initial_level_table(std::span<const RunOutcomes> runs) {
  tables::Table table(
      "initial_levels", "Initial level against time and memory",
      {{"run", tables::ColumnType::text, "", "scene and depth of rays"},
       {"level", tables::ColumnType::integer, "1", "initial level"},
       {"build", tables::ColumnType::integer, "ps", "time until the initial tree is there"},
       {"total_change", tables::ColumnType::real, "fraction", "total time against that with the whole tree"},
       {"memory_share", tables::ColumnType::real, "fraction", "memory as a share of the whole tree's"},
       {"building_share", tables::ColumnType::real, "fraction",
        "compute time for building, before the frame and in it, as a share of the whole tree's"}});
  for (const RunOutcomes& run : runs) {
    const LevelOutcome& whole = run.whole();
    for (const LevelOutcome& outcome : run.levels) {
      table.add_row({name_of(run.run), tables::count_cell(outcome.initial.level), outcome.build,
                     change(outcome.total(), whole.total()), 1.0 - saved(outcome.bytes, whole.bytes),
                     1.0 - saved(ticks(outcome.building()), ticks(whole.building()))});
    }
  }
  return table;
}

tables::Table savings_table(std::span<const RunOutcomes> runs, std::span<const double> rules) {
  tables::Table table("savings", "What the rules save against building the whole tree before the frame",
                      {{"run", tables::ColumnType::text, "", "scene and depth of rays"},
                       {"k", tables::ColumnType::real, "", "the rule's factor"},
                       {"level", tables::ColumnType::integer, "1", "the initial level it chooses"},
                       {"memory_saved", tables::ColumnType::real, "fraction", "memory"},
                       {"building_saved", tables::ColumnType::real, "fraction", "compute time for building"},
                       {"render_change", tables::ColumnType::real, "fraction",
                        "time of the frame, building on demand included"},
                       {"total_change", tables::ColumnType::real, "fraction", "time of building and frame"}});
  for (const RunOutcomes& run : runs) {
    const LevelOutcome& whole = run.whole();
    for (const double k : rules) {
      const LevelOutcome* outcome = run.by_rule(k);
      sim::ensure(outcome != nullptr, "a rule was not tried");
      table.add_row({name_of(run.run), k, tables::count_cell(outcome->initial.level),
                     saved(outcome->bytes, whole.bytes),
                     saved(ticks(outcome->building()), ticks(whole.building())),
                     change(outcome->render, whole.render), change(outcome->total(), whole.total())});
    }
  }
  return table;
}

}  // namespace marti::studies::paper
