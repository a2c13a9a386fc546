// The timed points of a sweep, as a report needs them: axes with their values in order, and figures.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "studies/sweep/store/answers.h"
#include "studies/sweep/store/axis_effects.h"
#include "studies/tables/table.h"

namespace marti::studies::report {

/// Something that the sweep varies: a key, with the keys that change together with it.
struct ReportAxis {
  std::string name;                    ///< of the key; "point" for named points
  std::vector<std::string> followers;  ///< keys whose values follow from this one's
  std::vector<tables::Cell> values;    ///< ascending, or of texts in the order of the points
  std::vector<std::string> texts;      ///< the values for people: "16 KiB"
  bool numeric = false;
  bool logarithmic = false;  ///< all above 0, and further apart at the upper end
  bool integer = false;      ///< all are whole numbers
  std::string unit;          ///< of a numeric axis: "byte", "Hz", "ps", ...; may be empty

  [[nodiscard]] double number(std::size_t value) const;  ///< of a numeric axis
};

struct ReportPoint {
  std::int64_t ordinal = 0;
  std::int64_t machine = 0;
  double cost = 0.0;
  std::vector<std::size_t> place;                      ///< for each axis the index of its value
  std::map<std::string, double, std::less<>> figures;  ///< those that the point has
  std::size_t frame = 0;                               ///< which of the sweep's frames it renders, from 0
  std::string advice;                                  ///< what would help it, measured; may be empty
  std::optional<double> noise;                         ///< of its frame time (sweep::Advice::noise)

  /// 0 when the point has none of this name.
  [[nodiscard]] double figure(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const { return figures.find(name) != figures.end(); }
};

struct ReportPoints {
  std::string version;  ///< of the program that timed them
  std::vector<ReportAxis> axes;
  std::vector<ReportPoint> points;  ///< that have been timed, in the order of the plan
  std::size_t planned = 0;
  std::size_t frames = 1;      ///< that differ in their scene, rays or image: frames of different work
  bool priced = false;         ///< costs differ
  sweep::Answers answers;      ///< to what the sweep asks
  sweep::AxisEffects effects;  ///< which axis changes the frame time most
  std::vector<std::pair<std::string, std::string>> settings;  ///< that all timed points share, by key
  std::vector<std::pair<std::string, std::string>> provenance;

  [[nodiscard]] std::optional<std::size_t> axis(std::string_view name) const;
};

}  // namespace marti::studies::report
