// Two results compared: their points joined, what differs between points that have found each other, and what
// that says in sentences.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/compare/differences.h"
#include "studies/compare/figures.h"
#include "studies/compare/results.h"

namespace marti::studies::compare {

/// How points find each other.
enum class Join : std::uint8_t {
  one,       ///< there is one on each side
  each,      ///< the one of one side with each point of a sweep
  axes,      ///< points of sweeps by the values of the axes that tell them apart, which both sweeps have
  settings,  ///< points of other sweeps by all settings; of points with the same machine only the first
};

/// One of the two results.
struct Side {
  std::string name;  ///< Results::name()
  std::string version;
  std::string helps{};      ///< ComparedResult::helps; of Join::one
  std::size_t planned = 0;  ///< points
  std::size_t timed = 0;
  std::vector<std::int64_t> alone{};  ///< ordinals of points that only this sweep has, ascending
};

/// Two points that are compared. Both have been timed.
struct JoinedPoint {
  std::int64_t a = 0;  ///< ordinals
  std::int64_t b = 0;
  std::vector<tables::Cell> values;  ///< of Comparison::axes
  std::string name;                  ///< these values: "machine.nodes 8, cache.size 4 KiB"
  std::int64_t end_a = 0;            ///< frame times, ps; only of Join::one 0 where a result has none
  std::int64_t end_b = 0;
  bool same_frame = false;           ///< only then its times can be compared
  std::vector<Difference> settings;  ///< that differ, without the alike ones
  /// In how many settings that both use A and B differ, and in those with numbers above 0 how often one value
  /// must be doubled to be the other.
  std::size_t distance = 0;
  double doublings = 0.0;

  [[nodiscard]] double ratio() const { return static_cast<double>(end_b) / static_cast<double>(end_a); }
};

/// A figure where it differs most among the joined points.
struct FigureDifference : Difference {
  std::int64_t point_a = 0;
  std::int64_t point_b = 0;
  std::size_t points = 0;  ///< that differ in it
};

struct Comparison {
  Join join = Join::one;
  Side a;
  Side b;
  bool sweep_is_a = false;        ///< the points are named by A's ordinals and axes; else by B's
  std::vector<std::string> axes;  ///< of that sweep
  std::size_t both = 0;           ///< points that both have
  /// Timed on both sides, those of equal frames first. Beside a result the sweep's shortest frame comes
  /// first; of different frames the point that differs least. Of two sweeps the largest ratio of the frame
  /// times comes first, in either direction. Then by ordinal.
  std::vector<JoinedPoint> points;
  std::size_t comparable = 0;       ///< so many of `points` are of equal frames
  sweep::Noise noise;               ///< the larger Results::noise()
  std::size_t nearest = 0;          ///< the point that differs least
  std::vector<Difference> frame;    ///< settings in which frames differ, each as the first point has it
  std::vector<Difference> alike;    ///< settings that differ at every joined point by the same values
  std::size_t varied_settings = 0;  ///< others that differ
  std::size_t equal_settings = 0;   ///< that are equal at every joined point
  std::string own_values;           ///< of Join::each: of the result in the settings that are axes, as a name
  std::vector<ActivityTime> times;  ///< of the comparable points
  /// Figures that differ, in the order of Differences::figures; of sweeps only the counted ones of the
  /// machine.
  std::vector<FigureDifference> figures;
  std::vector<FigureDifference> equal;  ///< of Join::one
  std::size_t equal_figures = 0;
  std::size_t equal_points = 0;  ///< in which none of `figures` differs

  /// Whether the frame times differ, but by no more than the noise.
  [[nodiscard]] bool within_noise(const JoinedPoint& of) const {
    return of.end_a != of.end_b && std::abs(of.ratio() - 1.0) <= noise.band;
  }
  /// How many of the comparable points are so.
  [[nodiscard]] std::size_t points_within_noise() const {
    return static_cast<std::size_t>(
        std::count_if(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(comparable),
                      [this](const JoinedPoint& point) { return within_noise(point); }));
  }
  /// The ordinal and the frame time that the sweep has for a point.
  [[nodiscard]] std::int64_t point(const JoinedPoint& of) const { return sweep_is_a ? of.a : of.b; }
  [[nodiscard]] std::int64_t end(const JoinedPoint& of) const { return sweep_is_a ? of.end_a : of.end_b; }
};

/// Throws UserError when a run is compared with a sweep of which no point has been timed, and when there is a
/// sweep and a point has no frame time.
[[nodiscard]] Comparison compared(Results& a, Results& b);

/// The most important sentence first. Of frames that differ it says what differs in them, and not that a
/// machine is faster. Two results without a frame time have none.
[[nodiscard]] std::vector<std::string> verdict_of(const Comparison& found);

/// What would make each frame shorter, where it is recorded; of two results.
[[nodiscard]] std::vector<std::string> helps_of(const Comparison& found);

/// The geometric mean of the ratios B / A of the comparable points; std::nullopt without one.
[[nodiscard]] std::optional<double> mean_ratio(const Comparison& found);

}  // namespace marti::studies::compare
