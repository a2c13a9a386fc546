#include "studies/text_units.h"

#include <fmt/format.h>

namespace marti::studies {

std::string seconds(sim::Ticks ticks) {
  const double s = static_cast<double>(ticks) / static_cast<double>(sim::ticks_per_second);
  if (s >= 1.0) {
    return fmt::format("{:.3f} s", s);
  }
  if (s >= 1e-3) {
    return fmt::format("{:.3f} ms", s * 1e3);
  }
  return fmt::format("{:.3f} us", s * 1e6);
}

}  // namespace marti::studies
