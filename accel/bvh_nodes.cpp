#include "accel/bvh_nodes.h"

#include <algorithm>
#include <cmath>

namespace marti::accel {

namespace {

// The smallest step; boxes thinner than 255 of them are a plane for a float of order 1.
constexpr int least_exponent = -64;

// The least exponent e such that 255 steps of 2^e reach from `lo` to `hi`.
int exponent_for(float lo, float hi) {
  int e = least_exponent;
  const double extent = static_cast<double>(hi) - static_cast<double>(lo);
  if (extent > 0.0) {
    e = std::max(e, std::ilogb(extent) - 8);
  }
  while (std::ldexp(255.0, e) < extent) {
    ++e;
  }
  return e;
}

}  // namespace

BvhQuantisedNode BvhQuantisedNode::make(std::uint32_t /*first*/, std::span<const BvhBox> boxes,
                                        std::span<const BvhChild> children) {
  BvhQuantisedNode node;
  BvhBox all;
  for (const BvhBox& box : boxes) {
    all.include(box);
  }
  std::uint32_t tests = 0;
  bool seen_branch = false;
  bool seen_leaf = false;
  for (std::size_t c = 0; c < children.size(); ++c) {
    const std::uint32_t entries = children[c].entries;
    if (entries == 0) {
      node.first_branch = seen_branch ? node.first_branch : children[c].record;
      seen_branch = true;
      node.branches = static_cast<std::uint8_t>(node.branches | (1U << c));
      node.meta[c] = static_cast<std::uint8_t>(32 + c);
    } else {
      node.first_primitive = seen_leaf ? node.first_primitive : children[c].record;
      seen_leaf = true;
      node.meta[c] = static_cast<std::uint8_t>((((1U << entries) - 1U) << 5U) | tests);
      tests += entries;
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    node.corner[a] = all.lo[a];
    const int e = exponent_for(all.lo[a], all.hi[a]);
    node.exponent[a] = static_cast<std::uint8_t>(e + 127);
    const auto steps = [&](float x) {
      return std::ldexp(static_cast<double>(x) - static_cast<double>(all.lo[a]), -e);
    };
    for (std::size_t c = 0; c < boxes.size(); ++c) {
      node.plane[0][a][c] = static_cast<std::uint8_t>(std::floor(steps(boxes[c].lo[a])));
      node.plane[1][a][c] = static_cast<std::uint8_t>(std::min(std::ceil(steps(boxes[c].hi[a])), 255.0));
    }
  }
  return node;
}

scenes::Bounds BvhQuantisedNode::box(std::size_t c) const {
  scenes::Bounds box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    box.lo[axis] = static_cast<double>(corner[a]) + double{step(a)} * plane[0][a][c];
    box.hi[axis] = static_cast<double>(corner[a]) + double{step(a)} * plane[1][a][c];
  }
  return box;
}

}  // namespace marti::accel
