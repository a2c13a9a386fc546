#include "accel/moved_primitives.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string>

#include "sim/error.h"

namespace marti::accel {

namespace {

/// Compares bits, so that a zero with another sign counts as different.
template <std::size_t N>
bool same_bits(const std::array<double, N>& a, const std::array<double, N>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

/// Whether two shapes are equal in all values from which the others are computed.
bool same_shape(const QuadricShape& a, const QuadricShape& b) {
  return a.kind == b.kind && same_bits(a.center, b.center) && same_bits(a.axis, b.axis) &&
         same_bits(std::array{a.half, a.radius, a.slope}, std::array{b.half, b.radius, b.slope}) &&
         same_bits(a.lo, b.lo) && same_bits(a.hi, b.hi);
}

}  // namespace

std::vector<std::uint32_t> moved_primitives(const TriangleSet& before, const TriangleSet& after) {
  if (before.size() != after.size() || before.triangles() != after.triangles()) {
    throw sim::UserError("there are " + std::to_string(after.triangles()) + " triangles and " +
                         std::to_string(after.size() - after.triangles()) + " other primitives, there were " +
                         std::to_string(before.triangles()) + " and " +
                         std::to_string(before.size() - before.triangles()) +
                         "; only their places may change");
  }
  std::vector<std::uint32_t> moved;
  for (std::uint32_t id = 0; id < after.size(); ++id) {
    if (id < after.triangles() ? !same_bits(before[id], after[id])
                               : !same_shape(before.quadric(id), after.quadric(id))) {
      moved.push_back(id);
    }
  }
  return moved;
}

}  // namespace marti::accel
