// Two sweeps, joined point by point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/compare/differences.h"
#include "studies/compare/figures.h"

namespace marti::studies::compare {

/// A point of A and the point of B that it is compared with. Both have been timed.
struct JoinedPoint {
  std::int64_t a = 0;  ///< ordinals
  std::int64_t b = 0;
  std::string name;                  ///< the values of A's axes: "machine.nodes 8, cache.size 4 KiB"
  std::vector<tables::Cell> values;  ///< of A's axes
  std::vector<std::string> texts;    ///< these values as people write them: "4 KiB"
  std::int64_t end_a = 0;            ///< ps
  std::int64_t end_b = 0;
  bool same_frame = false;           ///< only then its times can be compared
  std::vector<Difference> settings;  ///< that differ, without the alike ones

  [[nodiscard]] double ratio() const { return static_cast<double>(end_b) / static_cast<double>(end_a); }
};

/// What is known of one counter over all joined points.
struct CounterDifference {
  Difference largest;  ///< the largest relative one; its name is the counter's
  std::int64_t a = 0;  ///< at which point
  std::int64_t b = 0;
  std::size_t points = 0;  ///< that differ in it
};

/// How much of A's frame time an activity's change is, as the mean of the points: all activities together are
/// the mean of B / A - 1.
struct MeanChange {
  std::string activity;
  double of_frame = 0.0;
};

struct TwoSweeps {
  std::string a;  ///< names
  std::string b;
  std::string version_a;
  std::string version_b;
  std::vector<std::string> axes;  ///< of A
  bool by_axes = false;           ///< joined by the values of the axes, which both have; else by all settings
  std::size_t both = 0;           ///< points that both have
  std::vector<std::int64_t> only_a;  ///< ordinals, ascending
  std::vector<std::int64_t> only_b;
  /// Timed in both: the largest ratio of the frame times, in either direction, first, then by ordinal; points
  /// of different frames last.
  std::vector<JoinedPoint> points;
  std::size_t equal = 0;          ///< of these, equal in every counter
  std::vector<Difference> frame;  ///< settings in which the frames of joined points differ
  std::vector<Difference> alike;  ///< settings that differ at every joined point by the same values
  /// Of the comparable points that have the times; the largest change first, then by name.
  std::vector<MeanChange> times;
  std::size_t counters = 0;                  ///< that are compared
  std::vector<CounterDifference> differing;  ///< the largest relative difference first

  /// Joined points of equal frames; they are the first ones of `points`.
  [[nodiscard]] std::size_t comparable() const;
};

/// Of points with the same machine only the first is joined by settings.
[[nodiscard]] TwoSweeps two_sweeps(const std::filesystem::path& a, const std::filesystem::path& b);

/// The geometric mean of the ratios B / A of comparable points; std::nullopt without a comparable point.
[[nodiscard]] std::optional<double> mean_ratio(const TwoSweeps& found);

/// The most important sentence first.
[[nodiscard]] std::vector<std::string> verdict_of(const TwoSweeps& found);

[[nodiscard]] std::string text_of(const TwoSweeps& found, bool all);
[[nodiscard]] std::string json_of(const TwoSweeps& found);

}  // namespace marti::studies::compare
