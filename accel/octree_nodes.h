// The octree as its walks read it: compact nodes, and the triangles of leaves in packs of four.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "accel/frame.h"
#include "accel/triangles.h"

namespace marti::accel {

/// Eight bytes. Branch: `first` is its first child's number, the low eight bits of `info` say which
/// children are not empty leaves. Leaf: `first` is its first entry, `info` the number of entries | leaf_bit.
struct OctreeNode {
  static constexpr std::uint32_t leaf_bit = 0x80000000U;

  std::uint32_t first = 0;
  std::uint32_t info = 0;

  [[nodiscard]] bool leaf() const { return (info & leaf_bit) != 0; }
  [[nodiscard]] std::uint32_t entries() const { return info & ~leaf_bit; }
};

/// The index of node 0 in memory: the eight children of a branch, which begin at 1 + 8k, then fill exactly
/// one cache line.
inline constexpr std::size_t node_offset = 7;

/// Four triangles side by side: coordinate[3 * corner + axis][lane]. A leaf's last pack repeats its last
/// primitive in the unused lanes, which changes no result. The coordinates of a sphere, cylinder or cone are
/// NaN: its lane is then never refused by the sign test but passed to the scalar kernel.
struct alignas(64) TrianglePack {
  std::array<std::array<double, 4>, 9> coordinate;
  std::array<std::uint32_t, 4> id;
};

/// The data of a walk, by reference. The walks for any scalar are templates over the view: the lazy octree's
/// view has the same members (lazy_octree.h), but no packs.
struct OctreeView {
  using Record = OctreeNode;
  static constexpr bool has_packs = true;

  /// The record of node `n`.
  [[nodiscard]] const OctreeNode& node(std::uint32_t n) const { return nodes[n]; }
  /// The triangles that a leaf lists.
  [[nodiscard]] const std::uint32_t* list(const OctreeNode& record) const { return entries + record.first; }

  const OctreeNode* nodes;   ///< nodes[0] is the root
  const OctreeNode* packed;  ///< as nodes, but `first` of a leaf is its first pack; null without packs
  const TrianglePack* packs;
  const std::uint32_t* entries;  ///< triangle ids
  const TriangleSet* triangles;
  const RootFrame* frame;
};

}  // namespace marti::accel
