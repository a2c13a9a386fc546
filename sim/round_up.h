// Multiples of a number.
#pragma once

#include <cstdint>

namespace marti::sim {

/// The least multiple of `multiple`, which must not be 0, that is not below `value`. The result must fit.
[[nodiscard]] constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace marti::sim
