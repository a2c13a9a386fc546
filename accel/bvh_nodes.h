// The records of a bounding volume hierarchy as its walks read them; their layouts are those that a simulated
// machine reads (docs/internals/bvh.md). A record holds the boxes of a branch's children, and says of each
// whether it is a branch, and where, or a leaf, and what it lists. Leaves have no records.
//
// Coordinates are those of BvhSpace.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/bvh_box.h"
#include "accel/triangles.h"
#include "scenes/scene.h"

namespace marti::accel {

/// What a record says of a child beside its box.
struct BvhChild {
  std::uint32_t record;   ///< branch: its record; leaf: the first of its BvhPrimitives
  std::uint32_t entries;  ///< number of primitives of a leaf; 0: a branch
};

/// A copy of what a leaf lists: a triangle's corners, in the order in which walks come to the leaves. Others
/// than triangles are known by their ids alone.
struct BvhPrimitive {
  TriangleCorners corners;
  std::uint32_t id;
};

/// A box that no ray meets, for children that are not there; finite, so that no product is NaN.
inline constexpr float bvh_nowhere = 0x1p50F;

/// Up to Width children with their boxes in floats: 32 bytes for each.
template <std::size_t Width>
struct alignas(64) BvhNode {
  static constexpr std::size_t width = Width;
  /// Integer operations that find a child's number and record: its number is added.
  static constexpr std::uint32_t child_operations = 1;

  /// plane[0][axis][child] is a box's lower plane, plane[1] its upper one.
  std::array<std::array<std::array<float, Width>, 3>, 2> plane{};
  std::array<std::uint32_t, Width> record{};
  std::uint32_t first = 0;  ///< number of the first child in the topology
  std::array<std::uint8_t, Width> entries{};
  std::uint8_t count = 0;  ///< number of children

  [[nodiscard]] static BvhNode make(std::uint32_t first, std::span<const BvhBox> boxes,
                                    std::span<const BvhChild> children) {
    BvhNode node;
    node.first = first;
    node.count = static_cast<std::uint8_t>(boxes.size());
    for (std::size_t c = 0; c < Width; ++c) {
      for (std::size_t a = 0; a < 3; ++a) {
        node.plane[0][a][c] = c < boxes.size() ? boxes[c].lo[a] : bvh_nowhere;
        node.plane[1][a][c] = c < boxes.size() ? boxes[c].hi[a] : -bvh_nowhere;
      }
      if (c < children.size()) {
        node.record[c] = children[c].record;
        node.entries[c] = static_cast<std::uint8_t>(children[c].entries);
      }
    }
    return node;
  }

  [[nodiscard]] std::uint32_t children() const { return count; }
  [[nodiscard]] BvhChild child(std::size_t c) const { return {record[c], entries[c]}; }
  [[nodiscard]] scenes::Bounds box(std::size_t c) const {
    scenes::Bounds bounds;
    bounds.lo = {plane[0][0][c], plane[0][1][c], plane[0][2][c]};
    bounds.hi = {plane[1][0][c], plane[1][1][c], plane[1][2][c]};
    return bounds;
  }
};

/// Eight children in 80 bytes, after Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs
/// Through Compressed Wide BVHs", High-Performance Graphics 2017, section 3.1: a box's planes are bytes that
/// count steps of a power of two from the corner of the node's own box, and are rounded outwards. Unlike
/// there, children are not placed by octant, because the walk orders them by distance.
struct alignas(16) BvhQuantisedNode {
  static constexpr std::size_t width = 8;
  /// As in BvhNode. Four more: testing the child's bit in `branches`, masking the bits below it, counting
  /// them, and adding the count to the place of the first child.
  static constexpr std::uint32_t child_operations = 5;

  std::array<float, 3> corner{};
  std::array<std::uint8_t, 3> exponent{};  ///< of the steps, as a float holds it: plus 127
  std::uint8_t branches = 0;               ///< bit c: child c is a branch
  std::uint32_t first_branch = 0;          ///< record of the first child that is a branch; others follow
  std::uint32_t first_primitive = 0;       ///< of the first child that is a leaf; others follow
  /// 0: not there. A branch: 32 + its number. A leaf: in the upper three bits as many ones as it has
  /// primitives, in the lower five the number of primitives of the leaves before it.
  std::array<std::uint8_t, 8> meta{};
  std::array<std::array<std::array<std::uint8_t, 8>, 3>, 2> plane{};  ///< as in BvhNode

  [[nodiscard]] static BvhQuantisedNode make(std::uint32_t first, std::span<const BvhBox> boxes,
                                             std::span<const BvhChild> children);

  [[nodiscard]] float step(std::size_t axis) const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(exponent[axis]) << 23U);
  }
  [[nodiscard]] bool is_branch(std::size_t c) const { return ((branches >> c) & 1U) != 0; }
  [[nodiscard]] std::uint32_t children() const {
    std::uint32_t count = 0;
    while (count < 8 && meta[count] != 0) {
      ++count;
    }
    return count;
  }
  [[nodiscard]] BvhChild child(std::size_t c) const {
    const auto before = static_cast<std::uint32_t>(std::popcount(branches & ((1U << c) - 1U)));
    return is_branch(c)
               ? BvhChild{first_branch + before, 0}
               : BvhChild{first_primitive + (meta[c] & 31U),
                          static_cast<std::uint32_t>(std::popcount(static_cast<unsigned>(meta[c]) >> 5U))};
  }
  [[nodiscard]] scenes::Bounds box(std::size_t c) const;
};

/// Six children in 64 bytes, as in the nodes that Intel's units read (Embree 4,
/// kernels/rthwif/rtbuild/qbvh6.h, InternalNode6) and that Vulkan-Sim therefore traces: boxes in bytes as in
/// BvhQuantisedNode. Unlike there, leaves are not among the records, so the place of the first one is noted
/// beside that of the first branch.
struct alignas(64) BvhSixNode {
  static constexpr std::size_t width = 6;
  /// As in BvhNode. Eleven more find a leaf: a shift and a mask for its own four bits, a mask for those of
  /// the children before it, seven to add these (three masks, two shifts, an addition, a multiplication), and
  /// adding the sum to the place of the first one. A branch counts zeros instead, in as many.
  static constexpr std::uint32_t child_operations = 12;

  /// As in BvhNode. They come first, so that eight bytes can be read at each place that has six.
  std::array<std::array<std::array<std::uint8_t, 6>, 3>, 2> plane{};
  std::array<float, 3> corner{};
  std::uint32_t first_branch = 0;     ///< record of the first child that is a branch; others follow
  std::uint32_t first_primitive = 0;  ///< of the first child that is a leaf; others follow
  std::uint32_t entries = 0;          ///< four bits for each child: 0 for a branch, else how many primitives
  std::array<std::uint8_t, 3> exponent{};  ///< as in BvhQuantisedNode
  std::uint8_t count = 0;                  ///< number of children

  [[nodiscard]] static BvhSixNode make(std::uint32_t first, std::span<const BvhBox> boxes,
                                       std::span<const BvhChild> children);

  [[nodiscard]] float step(std::size_t axis) const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(exponent[axis]) << 23U);
  }
  [[nodiscard]] std::uint32_t children() const { return count; }
  [[nodiscard]] BvhChild child(std::size_t c) const {
    const std::uint32_t own = (entries >> (4 * c)) & 15U;
    const std::uint32_t before = entries & ((1U << (4 * c)) - 1U);
    if (own != 0) {
      const std::uint32_t pairs = (before & 0x0F0F0FU) + ((before >> 4U) & 0x0F0F0FU);
      return {first_primitive + (((pairs * 0x010101U) >> 16U) & 0xFFU), own};
    }
    const std::uint32_t halves = before | (before >> 2U);
    const auto leaves = static_cast<std::uint32_t>(std::popcount((halves | (halves >> 1U)) & 0x111111U));
    return {first_branch + static_cast<std::uint32_t>(c) - leaves, 0};
  }
  [[nodiscard]] scenes::Bounds box(std::size_t c) const;
};
static_assert(sizeof(BvhNode<2>) == 64 && sizeof(BvhNode<4>) == 128 && sizeof(BvhNode<8>) == 256 &&
              sizeof(BvhQuantisedNode) == 80 && sizeof(BvhSixNode) == 64);

/// A node whose planes are bytes that count steps.
template <class Node>
concept BvhInBytes = requires(const Node& node) {
  node.step(0);
};

}  // namespace marti::accel
