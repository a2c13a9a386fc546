// How the memory that a sweep may take is shared out.
#pragma once

#include <cstdint>

namespace marti::studies {

struct SweepMemory {
  std::uint64_t logs = 0;      ///< work logs
  std::uint64_t strips = 0;    ///< stripped logs
  std::uint64_t machines = 0;  ///< machines that are being timed
};

[[nodiscard]] constexpr SweepMemory shares_of(std::uint64_t limit) {
  return {limit / 2, limit / 4, limit - limit / 2 - limit / 4};
}

}  // namespace marti::studies
