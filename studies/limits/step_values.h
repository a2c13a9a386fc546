// Values of a step on the axis of its key.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <variant>

#include "studies/helps/change.h"

namespace marti::studies::limits {

/// The value of the one key that the change sets; std::nullopt if it sets several or the value is no number.
inline std::optional<double> number_of(const helps::Change& change) {
  if (change.settings.size() != 1 || change.settings[0].values.size() != 1) {
    return std::nullopt;
  }
  const sim::Value& value = change.settings[0].values[0];
  if (const auto* const whole = std::get_if<std::int64_t>(&value)) {
    return static_cast<double>(*whole);
  }
  const auto* const real = std::get_if<double>(&value);
  return real != nullptr ? std::optional(*real) : std::nullopt;
}

/// How far `to` is from `from` towards `beyond`, in logarithms; all are above 0.
inline double part_of_way(double from, double to, double beyond) {
  return std::log(to / from) / std::log(beyond / from);
}

}  // namespace marti::studies::limits
