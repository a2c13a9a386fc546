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

// Writes the boxes of a node's children as steps from the lower corner of them all.
template <class Node>
void write_boxes(Node& node, std::span<const BvhBox> boxes) {
  BvhBox all;
  for (const BvhBox& box : boxes) {
    all.include(box);
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
}

template <class Node>
scenes::Bounds read_box(const Node& node, std::size_t c) {
  scenes::Bounds box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    box.lo[axis] = static_cast<double>(node.corner[a]) + double{node.step(a)} * node.plane[0][a][c];
    box.hi[axis] = static_cast<double>(node.corner[a]) + double{node.step(a)} * node.plane[1][a][c];
  }
  return box;
}

}  // namespace

BvhQuantisedNode BvhQuantisedNode::make(std::uint32_t /*first*/, std::span<const BvhBox> boxes,
                                        std::span<const BvhChild> children) {
  BvhQuantisedNode node;
  write_boxes(node, boxes);
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
  return node;
}

scenes::Bounds BvhQuantisedNode::box(std::size_t c) const { return read_box(*this, c); }

BvhSixNode BvhSixNode::make(std::uint32_t /*first*/, std::span<const BvhBox> boxes,
                            std::span<const BvhChild> children) {
  BvhSixNode node;
  write_boxes(node, boxes);
  node.count = static_cast<std::uint8_t>(children.size());
  bool seen_branch = false;
  bool seen_leaf = false;
  for (std::size_t c = 0; c < children.size(); ++c) {
    const bool branch = children[c].entries == 0;
    bool& seen = branch ? seen_branch : seen_leaf;
    if (!seen) {
      (branch ? node.first_branch : node.first_primitive) = children[c].record;
    }
    seen = true;
    node.entries |= children[c].entries << (4 * c);
  }
  return node;
}

scenes::Bounds BvhSixNode::box(std::size_t c) const { return read_box(*this, c); }

}  // namespace marti::accel
