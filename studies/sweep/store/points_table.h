// The points of a sweep's store as tables.
#pragma once

#include <optional>
#include <string>

#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/table.h"

namespace marti::studies::sweep {

/// "points": a row for each point of the present plan whose machine has been timed: its axes, its cost, the
/// derived figures, and all counters. Its columns have the names and units of the store's; a key that is true
/// or false is a boolean.
[[nodiscard]] tables::Table points_table(const SweepReader& reader);

/// The fastest machine of those with advice, and what would help it, as lines for people; empty where none
/// has advice.
[[nodiscard]] std::string fastest_text(const SweepReader& reader);

/// Which points are worth their price.
struct BestPoints {
  /// "best": the points that no other beats in cost and metric, ascending by cost; its last column marks the
  /// best within the budget.
  tables::Table front;
  std::string text;  ///< for people: the best within the budget, and the front
};

/// `metric` is a figure of SweepReader::figures(). Throws UserError when it is not, or when no point within
/// the budget has it.
[[nodiscard]] BestPoints best_points(const SweepReader& reader, const std::string& metric,
                                     std::optional<double> budget);

}  // namespace marti::studies::sweep
