// What a tree holds level by level: whole, or as a frame leaves it when its nodes are divided only when a ray
// first needs them; and how often a frame visits each level.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/topology.h"
#include "memory/layout.h"
#include "processors/program/work_log.h"

namespace marti::studies::paper {

/// The nodes of one level: B branches, L leaves, and P partially built nodes, which list their triangles and
/// have not been divided yet.
struct LevelCount {
  std::uint64_t branches = 0;
  std::uint64_t leaves = 0;
  std::uint64_t partial = 0;
  std::uint64_t leaf_entries = 0;     ///< triangles listed by leaves
  std::uint64_t partial_entries = 0;  ///< triangles listed by partially built nodes

  [[nodiscard]] std::uint64_t nodes() const { return branches + leaves + partial; }
  /// L / (B + P); infinite when all nodes are leaves, std::nullopt when there is no node.
  [[nodiscard]] std::optional<double> leaf_ratio() const;
  bool operator==(const LevelCount&) const = default;
};

/// Level by level, the root's first. The tree must have been built by dividing nodes (octree, BSP tree).
[[nodiscard]] std::vector<LevelCount> count_levels(const accel::Topology& topology);

/// The tree after the frame of `touched`, when it was built to `initial_level` before (the root is level 1,
/// and nodes of that level are not divided) and every node that a ray visited was divided then. `touched` has
/// a flag for each node. A level beyond the tree gives the whole tree.
[[nodiscard]] std::vector<LevelCount> count_lazy_levels(const accel::Topology& topology,
                                                        std::span<const std::uint8_t> touched,
                                                        std::uint32_t initial_level);

/// The first level n with L_n > k (B_n + P_n), at which building before the frame stops by the rule of the
/// 1992 paper (k = 3 after its worst case, in which a ray enters four children of a branch; k = 10 is what it
/// recommends). std::nullopt when there is no such level.
[[nodiscard]] std::optional<std::uint32_t> rule_level(std::span<const LevelCount> levels, double k);

/// What a frame did with each node: a pass over its log.
struct NodeVisits {
  std::vector<std::uint64_t> per_level;  ///< branches and leaves visited, the root's level first
  std::vector<std::uint64_t> tests;      ///< triangles tested in leaves of the level
  std::vector<std::uint64_t> distinct;   ///< nodes of the level visited at least once
  std::vector<std::uint8_t> touched;     ///< for each node: visited at least once
};
[[nodiscard]] NodeVisits count_visits(const processors::program::WorkLog& log);

/// Bytes of a level in the database: records of nodes and the lists of leaves and partially built nodes.
[[nodiscard]] std::uint64_t bytes_of(const LevelCount& level, const memory::LayoutConfig& layout);
[[nodiscard]] std::uint64_t bytes_of(std::span<const LevelCount> levels, const memory::LayoutConfig& layout);

}  // namespace marti::studies::paper
