// The points of a sweep's store as tables.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/table.h"

namespace marti::studies::sweep {

/// "points": a row for each point of the present plan whose machine has been timed: its axes, its cost, the
/// derived figures, and all counters. Its columns have the names and units of the store's; a key that is true
/// or false is a boolean.
[[nodiscard]] tables::Table points_table(const SweepReader& reader);

/// Name, unit and meaning of a column of that table; of any other name a column that was computed. Its type
/// is still to be set.
[[nodiscard]] tables::Column point_column(const std::string& name);

/// The fastest machine of those with advice, and what would help it, as lines for people; empty where none
/// has advice.
[[nodiscard]] std::string fastest_text(const SweepReader& reader);

/// How many frame times besides the least are within `noise` of it, a share of it.
[[nodiscard]] std::size_t within_noise(std::span<const double> times, double noise);

/// What is known of the noise of the fastest machine: its own by other orders of packets, where that was
/// measured, or that of the sweep's seeds, whichever is larger. std::nullopt: neither was measured.
[[nodiscard]] std::optional<Noise> noise_of_fastest(std::optional<double> own, const Noise& of_seeds);

/// "another order of packets changes its frame by up to 0.40 %, and 2 other points are within that".
[[nodiscard]] std::string fastest_noise_text(const Noise& noise, std::size_t others);

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
