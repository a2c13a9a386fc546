// How figures stand in an answer's sentences.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "studies/text_units.h"

namespace marti::studies {

/// "1.234 ms" for picoseconds; below 0 and beyond 2^62 the nearest of them.
[[nodiscard]] inline std::string time_text(double ps) {
  return seconds(static_cast<sim::Ticks>(std::llround(std::clamp(ps, 0.0, 0x1p62))));
}

}  // namespace marti::studies
