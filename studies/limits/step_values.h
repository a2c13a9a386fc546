// Values of a step on the axis of its key.
#pragma once

#include <cmath>
#include <optional>

#include "studies/helps/change.h"

namespace marti::studies::limits {

/// The value of the one key that the change sets; std::nullopt if it sets several or the value is no number.
inline std::optional<double> number_of(const helps::Change& change) {
  if (change.settings.size() != 1 || change.settings[0].values.size() != 1) {
    return std::nullopt;
  }
  return sim::number_of(change.settings[0].values[0]);
}

/// How far `to` is from `from` towards `beyond`, in logarithms; all are above 0.
inline double part_of_way(double from, double to, double beyond) {
  return std::log(to / from) / std::log(beyond / from);
}

}  // namespace marti::studies::limits
