// Building the binary tree under a bounding volume hierarchy.
//
// Binned surface area heuristic: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE
// Symposium on Interactive Ray Tracing 2007. A node's centroids are sorted into bins of equal width along
// each axis; it is split between the two bins where the children's areas times their numbers of primitives
// sum to the least (on ties at the lower axis, then at the lower bin). A visit to a branch costs as much as
// the test of a primitive. Where no split separates anything, as among coincident primitives, and where the
// tree would become deeper than 61 levels, a list is cut into halves.
//
// Built level by level. A node's split depends on its own list only, so nodes are split on any number of
// threads, and the tree is the same.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/bvh_box.h"
#include "accel/bvh_options.h"
#include "accel/bvh_work.h"
#include "accel/triangles.h"

namespace marti::accel {

/// A node of the binary tree, which ends at single primitives: `first` and `first` + 1 are the children of
/// any other node. It lists entries[begin] to entries[begin + count - 1].
struct BvhBinaryNode {
  BvhBox box;
  std::uint32_t begin = 0;
  std::uint32_t count = 0;
  std::uint32_t first = 0;
  bool leaf = true;         ///< its primitives cost less than its split, and a leaf can hold them
  bool below_leaf = false;  ///< below such a node
};

struct BvhBinaryTree {
  std::vector<BvhBinaryNode> nodes;    ///< node 0 is the root
  std::vector<std::uint32_t> entries;  ///< primitive ids
  BvhWork work;
};

/// Over one primitive or more of a set. Throws UserError when the memory does not suffice.
[[nodiscard]] BvhBinaryTree build_binary_bvh(const TriangleSet& triangles, PrimitiveRange range,
                                             const BvhSpace& space, const BvhOptions& options);

}  // namespace marti::accel
