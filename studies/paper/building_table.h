// Tables 2 to 5 of the paper: what it takes to build the octree to an initial level before the frame, and the
// rest of it when a ray first needs it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processors/cost/accounting.h"
#include "sim/time.h"
#include "studies/paper/level_counts.h"
#include "studies/paper/paper_keys.h"
#include "studies/tables/table.h"

namespace marti::studies::paper {

/// An initial level to try.
struct InitialLevel {
  std::uint32_t level = 1;
  bool whole = false;         ///< the whole tree is built before the frame
  std::vector<double> rules;  ///< k of the rules that choose this level

  /// "whole tree", "k = 3", "k = 3, k = 10", or empty.
  [[nodiscard]] std::string note() const;
};

/// The configured levels above the tree's deepest, those that the rules choose, and the whole tree, which
/// comes last; ascending, each once.
[[nodiscard]] std::vector<InitialLevel> initial_levels(const PaperConfig& config,
                                                       std::span<const LevelCount> levels);

/// One machine that began with the tree built to an initial level.
struct LevelOutcome {
  InitialLevel initial;
  sim::Ticks build = 0;               ///< until the initial tree was there
  sim::Ticks render = 0;              ///< from then to the end of the frame, building on demand included
  processors::cost::TimeSums time{};  ///< of all nodes together, from the beginning of the build
  std::uint64_t splits = 0;           ///< branches divided, before the frame and in it
  std::uint64_t nodes = 0;            ///< of the tree that the frame leaves: branches, leaves, partial
  std::uint64_t partial = 0;
  std::uint64_t bytes = 0;  ///< of its records and lists

  [[nodiscard]] sim::Ticks total() const { return sim::add_ticks(build, render); }
  /// Compute time for building, before the frame and in it.
  [[nodiscard]] sim::Ticks building() const {
    return sim::ticks_of(time[static_cast<std::size_t>(processors::cost::Activity::building)]);
  }
};

/// A run and all its outcomes; the last is the whole tree's.
struct RunOutcomes {
  PaperRun run;
  std::vector<LevelOutcome> levels;

  [[nodiscard]] const LevelOutcome& whole() const { return levels.back(); }
  /// The outcome of the level that a rule chooses; null when the rule was not tried.
  [[nodiscard]] const LevelOutcome* by_rule(double k) const;
};

/// How much smaller `value` is than `whole`, as a fraction of it; 0 where there is nothing to save.
[[nodiscard]] double saved(std::uint64_t value, std::uint64_t whole);

/// "table2" for the first run, "table3" for the second, and so on: a row for each initial level.
[[nodiscard]] tables::Table building_table(std::size_t index, const RunOutcomes& outcomes);

/// "initial_levels": the rows of all of them, for charts.
[[nodiscard]] tables::Table initial_level_table(std::span<const RunOutcomes> runs);

/// "savings": what each rule saves against building the whole tree.
[[nodiscard]] tables::Table savings_table(std::span<const RunOutcomes> runs, std::span<const double> rules);

}  // namespace marti::studies::paper
