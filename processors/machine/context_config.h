// Configuration of what hides a node's misses: several contexts, and prefetching.
#pragma once

#include <cstdint>

#include "accel/traversal.h"

namespace marti::processors {

/// The most contexts, and the most prefetches under way, of one node.
inline constexpr std::uint32_t most_contexts = 256;
/// The most of both that a machine may have.
inline constexpr std::uint64_t most_ports = std::uint64_t{1} << 28U;

/// Lines that a node's cache fetches before they are asked for. Both kinds need a cache and a shared
/// database.
struct PrefetchConfig {
  /// A miss also fetches the line behind its own when that is of the same section of the database: prefetch
  /// on a miss, one block ahead (Smith, Cache memories, ACM Computing Surveys 14(3), 1982, section 2.1).
  bool next_line = false;
  /// A visit to a branch also fetches the records of its children.
  bool children = false;
  std::uint32_t outstanding =
      4;  ///< most of them under way at a node, 1 to most_contexts; others are dropped

  [[nodiscard]] bool on() const { return next_line || children; }
};

/// Throws UserError when the walk has no children to prefetch: a grid's cells are not.
void check_prefetch(const PrefetchConfig& config, accel::Traversal traversal);

}  // namespace marti::processors
