// One result beside every point of a sweep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studies/compare/differences.h"
#include "studies/compare/figures.h"

namespace marti::studies::compare {

/// Which of A and B the sweep is; the result is the other.
enum class SweepSide : std::uint8_t { a, b };

struct ComparedPoint {
  std::int64_t ordinal = 0;
  std::string name;                  ///< in [sweep.points]; may be empty
  std::int64_t end = 0;              ///< ps
  double ratio = 0.0;                ///< frame time of B / frame time of A
  std::vector<Difference> settings;  ///< in which it differs from the result, without the alike ones
  std::size_t distance = 0;          ///< in how many settings that both use it differs from the result
  double doublings = 0.0;  ///< in those above 0: how often one value must be doubled to be the other
};

struct ResultAndSweep {
  std::string a;  ///< names
  std::string b;
  SweepSide side = SweepSide::b;
  std::int64_t end = 0;     ///< frame time of the result
  std::size_t planned = 0;  ///< points of the sweep
  std::size_t timed = 0;
  bool same_frame = false;  ///< at least one timed point renders the result's frame
  /// If same_frame, the timed points of that frame, the shortest frame time first, then by number. Else all
  /// timed points, the nearest first.
  std::vector<ComparedPoint> points;
  std::size_t other_frames = 0;  ///< timed points of other frames
  /// Settings of the frame in which points of other frames differ from the result, each as the first such
  /// point has it.
  std::vector<Difference> frame;
  std::vector<Difference> alike;  ///< settings in which all `points` differ from the result by the same value
  std::vector<Difference>
      varied;  ///< the others in which one of `points` differs, if possible of one that has them
  std::size_t equal_settings = 0;

  [[nodiscard]] bool sweep_is_a() const { return side == SweepSide::a; }
  [[nodiscard]] const char* result_letter() const { return sweep_is_a() ? "B" : "A"; }
  [[nodiscard]] const char* sweep_letter() const { return sweep_is_a() ? "A" : "B"; }
  [[nodiscard]] tables::Cell Difference::*of_result() const {
    return sweep_is_a() ? &Difference::b : &Difference::a;
  }
  [[nodiscard]] tables::Cell Difference::*of_sweep() const {
    return sweep_is_a() ? &Difference::a : &Difference::b;
  }
  /// The point that differs from the result in the fewest settings; of several the one whose values are
  /// nearest, then the first in number.
  [[nodiscard]] const ComparedPoint& nearest() const;
};

/// Whether the first is nearer to the result.
[[nodiscard]] bool is_nearer(const ComparedPoint& x, const ComparedPoint& y);

/// Throws UserError when no point has been timed, and when the result or a point has no frame time.
[[nodiscard]] ResultAndSweep result_and_sweep(const ComparedResult& result,
                                              const std::filesystem::path& sweep, SweepSide side);

/// "point 10 (cache.size 4 KiB, machine.nodes 8)"; with its name, if it has one.
[[nodiscard]] std::string point_text(const ResultAndSweep& found, const ComparedPoint& point);

/// The most important sentence first. Points of other frames are never called faster or slower.
[[nodiscard]] std::vector<std::string> verdict_of(const ResultAndSweep& found);

[[nodiscard]] std::string text_of(const ResultAndSweep& found, bool all);
[[nodiscard]] std::string json_of(const ResultAndSweep& found);

}  // namespace marti::studies::compare
