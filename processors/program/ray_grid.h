// What rays may be sorted by (docs/internals/rt-unit.md, Sorting rays): where they begin in a grid over the
// scene, and where they go, as one word.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "accel/ray.h"
#include "scenes/scene.h"

namespace marti::processors::program {

/// Cells of the grid along an axis, and of an octant of directions along a side.
inline constexpr unsigned origin_cell_bits = 5;
inline constexpr unsigned direction_cell_bits = 3;
/// The lower bits of a ray's word, for where it goes: its octant, then its cell. Above is the cell of its
/// origin in Morton order.
inline constexpr unsigned direction_bits = 3 + 2 * direction_cell_bits;

class RayGrid {
 public:
  explicit RayGrid(const scenes::Bounds& box) : box_(box) {}

  [[nodiscard]] std::uint32_t word(const accel::Ray& ray) const {
    return origin_cell(ray.origin) << direction_bits | direction_cell(ray.direction);
  }

 private:
  // The number of the cell that `place`, from 0 to 1, is in; outside, of the nearest one.
  static std::uint32_t cell(double place, unsigned bits) {
    const auto cells = static_cast<double>(1U << bits);
    const double at = place * cells;
    return at >= cells ? (1U << bits) - 1U : at > 0.0 ? static_cast<std::uint32_t>(at) : 0U;
  }
  [[nodiscard]] std::uint32_t origin_cell(const glm::dvec3& origin) const {
    std::uint32_t morton = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t along =
          cell((origin[axis] - box_.lo[axis]) / (box_.hi[axis] - box_.lo[axis]), origin_cell_bits);
      for (unsigned bit = 0; bit < origin_cell_bits; ++bit) {
        morton |= (along >> bit & 1U) << (3 * bit + static_cast<unsigned>(axis));
      }
    }
    return morton;
  }
  static std::uint32_t direction_cell(const glm::dvec3& direction) {
    std::uint32_t octant = 0;
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      octant |= direction[axis] < 0.0 ? 1U << static_cast<unsigned>(axis) : 0U;
      sum += std::abs(direction[axis]);
    }
    const std::uint32_t column = cell(std::abs(direction.x) / sum, direction_cell_bits);
    const std::uint32_t row = cell(std::abs(direction.y) / sum, direction_cell_bits);
    return (octant << direction_cell_bits | row) << direction_cell_bits | column;
  }

  scenes::Bounds box_;
};

}  // namespace marti::processors::program
