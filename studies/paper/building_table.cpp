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
    auto at = std::ranges::find_if(chosen, [level](const auto& c) { return c.level >= level; });
    if (at->level != level) {
      at = chosen.insert(at, {level, false, {}});
    }
    at->rules.push_back(k);
  }
  return chosen;
}

const LevelOutcome* RunOutcomes::by_rule(double k) const {
  for (const LevelOutcome& outcome : levels) {
    if (std::ranges::find(outcome.initial.rules, k) != outcome.initial.rules.end()) {
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
      {tables::count_column("level", "initial level: its nodes are not divided before the frame"),
       tables::text_column("note", "rules that choose the level"),
       tables::integer_column("build", "ps", "time until the initial tree is there"),
       tables::integer_column("render", "ps", "time from then on, building on demand included"),
       tables::integer_column("total", "ps", "both"),
       tables::integer_column("building", "ps",
                              "compute time for building before the frame and in it, all nodes together"),
       tables::count_column("splits", "nodes divided before the frame and in it"),
       tables::count_column("nodes", "nodes that the frame leaves"),
       tables::count_column("partial", "of these, nodes left partially built"),
       tables::integer_column("memory", "byte", "records and lists that the frame leaves"),
       tables::real_column("memory_saved", "fraction", "memory saved against the whole tree"),
       tables::real_column("building_saved", "fraction", "compute time for building saved against it"),
       tables::real_column("total_change", "fraction", "total time against it")});
  const LevelOutcome& whole = outcomes.whole();
  for (const LevelOutcome& outcome : outcomes.levels) {
    table.add_row({outcome.initial.level, outcome.initial.note(), outcome.build, outcome.render,
                   outcome.total(), outcome.building(), outcome.splits, outcome.nodes, outcome.partial,
                   outcome.bytes, saved(outcome.bytes, whole.bytes),
                   saved(ticks(outcome.building()), ticks(whole.building())),
                   change(outcome.total(), whole.total())});
  }
  return table;
}

tables::Table initial_level_table(std::span<const RunOutcomes> runs) {
  tables::Table table(
      "initial_levels", "Initial level against time and memory",
      {tables::text_column("run", "scene and depth of rays"), tables::count_column("level", "initial level"),
       tables::integer_column("build", "ps", "time until the initial tree is there"),
       tables::real_column("total_change", "fraction", "total time against that with the whole tree"),
       tables::real_column("memory_share", "fraction", "memory as a share of the whole tree's"),
       tables::real_column(
           "building_share", "fraction",
           "compute time for building, before the frame and in it, as a share of the whole tree's")});
  for (const RunOutcomes& run : runs) {
    const LevelOutcome& whole = run.whole();
    for (const LevelOutcome& outcome : run.levels) {
      table.add_row({name_of(run.run), outcome.initial.level, outcome.build,
                     change(outcome.total(), whole.total()), 1.0 - saved(outcome.bytes, whole.bytes),
                     1.0 - saved(ticks(outcome.building()), ticks(whole.building()))});
    }
  }
  return table;
}

tables::Table savings_table(std::span<const RunOutcomes> runs, std::span<const double> rules) {
  tables::Table table(
      "savings", "What the rules save against building the whole tree before the frame",
      {tables::text_column("run", "scene and depth of rays"),
       tables::real_column("k", "", "the rule's factor"),
       tables::count_column("level", "the initial level it chooses"),
       tables::real_column("memory_saved", "fraction", "memory"),
       tables::real_column("building_saved", "fraction", "compute time for building"),
       tables::real_column("render_change", "fraction", "time of the frame, building on demand included"),
       tables::real_column("total_change", "fraction", "time of building and frame")});
  for (const RunOutcomes& run : runs) {
    const LevelOutcome& whole = run.whole();
    for (const double k : rules) {
      const LevelOutcome* outcome = run.by_rule(k);
      sim::ensure(outcome != nullptr, "a rule was not tried");
      table.add_row({name_of(run.run), k, outcome->initial.level, saved(outcome->bytes, whole.bytes),
                     saved(ticks(outcome->building()), ticks(whole.building())),
                     change(outcome->render, whole.render), change(outcome->total(), whole.total())});
    }
  }
  return table;
}

}  // namespace marti::studies::paper
