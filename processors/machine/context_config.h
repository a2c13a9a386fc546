// Configuration of what hides the latency of a node's misses: several contexts, and prefetching.
#pragma once

#include <cstdint>

#include "accel/traversal.h"

namespace marti::processors::machine {

/// The most contexts of one node, and the most prefetches under way.
inline constexpr std::uint32_t most_contexts = 256;
/// The most contexts and prefetches together that a machine may have.
inline constexpr std::uint64_t most_ports = std::uint64_t{1} << 28U;

/// Prefetching: lines that a node's cache fetches before they are referenced. Both kinds need a cache and a
/// shared database.
struct PrefetchConfig {
  /// A miss also fetches the line behind its own when that is of the same section of the database: prefetch
  /// on a miss, one block ahead (Smith, Cache memories, ACM Computing Surveys 14(3), 1982, section 2.1).
  bool next_line = false;
  /// A visit to a branch also fetches the records of its children.
  bool children = false;
  std::uint32_t outstanding =
      4;  ///< most prefetches under way at a node, 1 to most_contexts; further ones are dropped

  [[nodiscard]] bool on() const { return next_line || children; }
};

/// Throws UserError when children are to be prefetched in a grid, whose cells have no children.
void check_prefetch(const PrefetchConfig& config, accel::Traversal traversal);

}  // namespace marti::processors::machine
