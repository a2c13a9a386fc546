// Where in a pixel its samples lie: jittered in the cells of a grid (Cook, "Stochastic Sampling in Computer
// Graphics", ACM TOG 5(1), 1986). The random numbers depend only on pixel, sample, dimension and seed, so
// that leaving a ray out does not shift the numbers of another (Salmon et al., "Parallel Random Numbers: As
// Easy as 1, 2, 3", SC 2011).
#pragma once

#include <cstdint>

#include "sim/mix.h"

namespace marti::processors::program {

/// A point of the image, in pixels from its upper left corner: pixel (x, y) is [x, x + 1) by [y, y + 1).
struct SamplePoint {
  double column = 0.0;
  double row = 0.0;
};

/// The upper 53 bits as a number of [0, 1).
[[nodiscard]] constexpr double unit_number(std::uint64_t bits) {
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}

/// 64 bits for each pixel (x, y below 32768), sample, dimension (below 4) and seed:
/// the finaliser of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014) over the counter, applied twice so that
/// neighbouring seeds share no sequence of numbers.
[[nodiscard]] constexpr std::uint64_t counted_bits(std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                                                   std::uint32_t dimension, std::uint64_t seed) {
  const std::uint64_t counter =
      std::uint64_t{y} << 32U | std::uint64_t{x} << 16U | std::uint64_t{sample} << 2U | dimension;
  return sim::mixed_bits(sim::mix(counter) ^ sim::mixed_bits(seed * sim::mix_step + 0x632be59bd9b4e019U));
}

/// counted_bits() as a number of [0, 1).
[[nodiscard]] constexpr double counted_number(std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                                              std::uint32_t dimension, std::uint64_t seed) {
  return unit_number(counted_bits(x, y, sample, dimension, seed));
}

/// The points of all pixels for a number of samples.
class SamplePoints {
 public:
  /// `samples` from 1 to 1024. They are dealt to a grid with one cell for each, as nearly square as whole
  /// numbers of rows and columns allow; a prime number of samples gives a single column.
  constexpr SamplePoints(std::uint32_t samples, std::uint64_t seed) : samples_(samples), seed_(seed) {
    for (std::uint32_t side = 1; side * side <= samples; ++side) {
      columns_ = samples % side == 0 ? side : columns_;
    }
  }

  /// One sample lies in the pixel's centre, each of several somewhere in its cell of the grid.
  [[nodiscard]] constexpr SamplePoint at(std::uint32_t x, std::uint32_t y, std::uint32_t sample) const {
    if (samples_ == 1) {
      return {x + 0.5, y + 0.5};
    }
    const std::uint32_t rows = samples_ / columns_;
    const std::uint32_t column = sample % columns_;
    const std::uint32_t row = sample / columns_;
    return {x + (column + counted_number(x, y, sample, 0, seed_)) / columns_,
            y + (row + counted_number(x, y, sample, 1, seed_)) / rows};
  }

  [[nodiscard]] constexpr std::uint32_t columns() const { return columns_; }

 private:
  std::uint32_t samples_;
  std::uint64_t seed_;
  std::uint32_t columns_ = 1;
};

}  // namespace marti::processors::program
