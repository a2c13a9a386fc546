// Building an octree level by level, on any number of host threads, to the last level or to an earlier one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "accel/frame.h"
#include "accel/octree_options.h"
#include "accel/topology.h"
#include "accel/triangles.h"

namespace marti::accel {

/// A node's number must fit in a work log's operand.
inline constexpr std::size_t most_octree_nodes = (std::size_t{1} << 28) - 8;

/// Where a build ends before the tree is complete. The nodes of the level at which it ends are not split.
struct BuildLimit {
  /// The last level; 0: no limit.
  std::uint32_t level = 0;
  /// If above 0: end at the first level with more than k times as many leaves as nodes to be split (McNeill
  /// et al. 1992: L_n > k (B_n + P_n); no node of the present level is a branch yet).
  double k = 0.0;
};

struct OctreeBuild {
  Topology topology;
  std::vector<LevelStatistics> levels;
  /// Leaves of the last level that the limit kept from being split, ascending. In the topology they are
  /// leaves with more than max_objects entries.
  std::vector<std::uint32_t> unsplit;
  /// Whether max_entries or most_octree_nodes kept a node from being split.
  bool cut = false;
};

/// Throws UserError, naming `structure`, when an option is out of range.
void check_octree_options(std::string_view structure, const OctreeOptions& options);

/// Builds over all triangles. The options must be in range and the frame made from these triangles. The
/// result is the same with any number of threads. Besides the result it needs 5 bytes for each triangle
/// listed on the present level and 4 on the next, 20 bytes for each of their nodes, and 128 for each node to
/// be split and each 2,048 triangles listed.
[[nodiscard]] OctreeBuild build_octree(const TriangleSet& triangles, const OctreeOptions& options,
                                       const RootFrame& frame, const BuildLimit& limit = {});

}  // namespace marti::accel
