// How much work it took to build a bounding volume hierarchy: what a machine that builds it the same way has
// to do at least (processors/cost/tree_work.h).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace marti::accel {

/// Of splits of nodes of the binary tree. A reference is a primitive's box and number.
struct BvhSplits {
  std::uint64_t nodes = 0;       ///< whose references were sorted into bins
  std::uint64_t references = 0;  ///< sorted into bins, each once a node
  std::uint64_t planes = 0;      ///< between bins, of which the cost was worked out
  std::uint64_t moved = 0;       ///< references moved to a child's part of the array

  bool operator==(const BvhSplits&) const = default;
  BvhSplits& operator+=(const BvhSplits& other) {
    nodes += other.nodes;
    references += other.references;
    planes += other.planes;
    moved += other.moved;
    return *this;
  }
};

/// Nodes below one that would be a leaf of the binary tree are left out, although the builder splits them to
/// fill nodes with many children; so are those that are cut into halves. The same at any number of threads.
struct BvhWork {
  /// By the nodes' numbers of references: [k], if there is one, has those of 2^(k-1) to 2^k - 1.
  std::vector<BvhSplits> by_size;
  /// Of the binary tree, down to the last of these nodes; of several trees, of the deepest.
  std::uint32_t levels = 0;

  bool operator==(const BvhWork&) const = default;
  [[nodiscard]] BvhSplits& of_size(std::uint32_t references) {
    const auto k = static_cast<std::size_t>(std::bit_width(references));
    by_size.resize(std::max(by_size.size(), k + 1));
    return by_size[k];
  }
  BvhWork& operator+=(const BvhWork& other) {
    by_size.resize(std::max(by_size.size(), other.by_size.size()));
    for (std::size_t k = 0; k < other.by_size.size(); ++k) {
      by_size[k] += other.by_size[k];
    }
    levels = std::max(levels, other.levels);
    return *this;
  }
};

}  // namespace marti::accel
