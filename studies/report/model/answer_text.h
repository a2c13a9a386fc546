// How figures and their names stand in sentences and headings.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "studies/tables/text_units.h"

namespace marti::studies::report {

/// A figure's name as words: "bank access" for "bank_access".
[[nodiscard]] inline std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// "1.234 ms" for picoseconds; below 0 and beyond 2^62 the nearest of them.
[[nodiscard]] inline std::string time_text(double ps) {
  return tables::seconds(static_cast<sim::Ticks>(std::llround(std::clamp(ps, 0.0, 0x1p62))));
}

}  // namespace marti::studies::report
