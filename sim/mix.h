// A mixing of 64 bits, for choices that must look random and always be alike.
#pragma once

#include <cstdint>

namespace marti::sim {

/// What the state of SplitMix64 grows by in each step (G. L. Steele, D. Lea, C. H. Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014).
inline constexpr std::uint64_t mix_step = 0x9e3779b97f4a7c15ULL;

/// SplitMix64's function from a state to the number that is drawn.
[[nodiscard]] constexpr std::uint64_t mixed_bits(std::uint64_t state) {
  state = (state ^ (state >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  state = (state ^ (state >> 27U)) * 0x94d049bb133111ebULL;
  return state ^ (state >> 31U);
}

/// Another number for each number, without a visible pattern: a whole step of SplitMix64.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t value) { return mixed_bits(value + mix_step); }

}  // namespace marti::sim
