// Which axis of a sweep changes the frame time most.
//
// The logarithm of the frame time is taken as a sum of one part for each axis, which depends on the axis'
// value, by least squares over the points that were timed (Box, Hunter and Hunter, Statistics for
// Experimenters, 2005, chapters 5 and 12). Where all values were combined with all others, the part of a
// value is the geometric mean of its points by that of all.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/sweep/store/axis_order.h"
#include "studies/sweep/store/sweep_reader.h"

namespace marti::studies::sweep {

struct AxisEffect {
  std::string axis;         ///< with the keys that change together with it: "cache.size + cache.ways"
  std::string fastest;      ///< its value with the shortest frames, for people, and
  std::string slowest;      ///< that with the longest
  double fastest_by = 1.0;  ///< their frame times by those of all points, both as geometric means
  double slowest_by = 1.0;
  [[nodiscard]] double ratio() const { return slowest_by / fastest_by; }  ///< at least 1
};

/// Two axes that do not act independently: `ratio` is that of the two frame times that differ most from what
/// the parts of both axes say, each as geometric mean of the points with one value of each axis.
struct Interaction {
  std::string first;
  std::string second;
  double ratio = 1.0;
};

struct AxisEffects {
  std::vector<AxisEffect> axes;  ///< the largest first
  std::vector<Interaction>
      interactions;  ///< the largest first; those that are larger than the least of `axes`
  Noise noise;       ///< SweepReader::noise(): an axis that changes less is not told from chance
};

/// `times` has the frame time of each point, above 0. Axes of one value have no effect and are left out.
[[nodiscard]] AxisEffects axis_effects(std::span<const AxisColumn> axes, std::span<const double> times);
/// Of the points that were timed.
[[nodiscard]] AxisEffects axis_effects(const SweepReader& reader);

/// "machine.nodes 12.80 times, cache.size 1.40 times; machine.nodes and cache.size together 1.10 times",
/// without a full stop; empty without axes. Axes within the noise are counted, not named, and what two
/// axes do together within it is left out.
[[nodiscard]] std::string effects_text(const AxisEffects& effects);

}  // namespace marti::studies::sweep
