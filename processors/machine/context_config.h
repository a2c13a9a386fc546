// Configuration of what hides the latency of a node's misses: several contexts, and prefetching.
#pragma once

#include <cstdint>

#include "accel/traversal.h"

namespace marti::processors::machine {

/// The most contexts of one node, and the most prefetches under way.
inline constexpr std::uint32_t most_contexts = 256;
/// The most entries of a lane's stack that are prefetched at a time, and lines that wait to be prefetched.
inline constexpr std::uint32_t most_prefetched_entries = 64;
inline constexpr std::uint32_t most_queued_prefetches = 4096;
/// The most contexts and prefetches together that a machine may have.
inline constexpr std::uint64_t most_ports = std::uint64_t{1} << 28U;

/// Prefetching: lines that a node's cache fetches before they are referenced. All kinds need a cache and a
/// shared database; next_line and children are for scalar nodes, stack and treelet for SIMT nodes.
struct PrefetchConfig {
  /// A miss also fetches the line behind its own when that is of the same section of the database: prefetch
  /// on a miss, one block ahead (Smith, Cache memories, ACM Computing Surveys 14(3), 1982, section 2.1).
  bool next_line = false;
  /// A visit to a branch also fetches the records of its children.
  bool children = false;
  std::uint32_t outstanding =
      4;  ///< most prefetches under way at a node, 1 to most_contexts; further ones are dropped

  /// A lane of the ray-tracing unit that goes on with an entry of its stack also has the records of so many
  /// entries below it fetched, 0 to most_prefetched_entries (Tozlu, Naithani, Zhou, "TTP: A
  /// Hardware-Efficient Design for Precise Prefetching in Ray Tracing", arXiv:2605.16253, 2026).
  std::uint32_t stack = 0;
  /// A lane of the ray-tracing unit that comes to want a record of another treelet than before also has all
  /// node records of that treelet fetched (Chou, Nowicki, Aamodt, "Treelet Prefetching For Ray Tracing",
  /// MICRO 2023). For LayoutConfig::node_order in treelets.
  bool treelet = false;
  std::uint32_t queue = 32;  ///< lines of a SIMT node that wait to be prefetched, 1 to most_queued_prefetches

  /// Whether a scalar node prefetches.
  [[nodiscard]] bool on() const { return next_line || children; }
  /// Whether a SIMT node does.
  [[nodiscard]] bool into_unit() const { return stack > 0 || treelet; }
};

/// Throws UserError when children are to be prefetched in a grid, whose cells have no children, or stacks in
/// another structure than a bounding volume hierarchy.
void check_prefetch(const PrefetchConfig& config, accel::Traversal traversal);

}  // namespace marti::processors::machine
