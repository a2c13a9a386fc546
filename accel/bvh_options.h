// The options of a bounding volume hierarchy.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "accel/traversal.h"
#include "sim/memory_budget.h"

namespace marti::accel {

/// How many children a branch has at most, and how their boxes are kept (bvh_nodes.h).
enum class BvhNodeKind : std::uint8_t { two, four, six, eight, eight_quantised };
inline constexpr std::array<std::string_view, 5> bvh_node_names = {"2", "4", "6", "8", "8_quantised"};

/// The walk by such nodes.
[[nodiscard]] constexpr Traversal traversal_of(BvhNodeKind kind) {
  constexpr std::array<Traversal, 5> walks = {Traversal::bvh_two, Traversal::bvh_four, Traversal::bvh_six,
                                              Traversal::bvh_eight, Traversal::bvh_eight_quantised};
  return walks[static_cast<std::size_t>(kind)];
}

/// Bytes of a branch's record. A leaf has none: its parent's record says where its list is.
[[nodiscard]] constexpr std::uint32_t bvh_record_bytes(BvhNodeKind kind) {
  constexpr std::array<std::uint32_t, 5> bytes = {64, 128, 64, 256, 80};
  return bytes[static_cast<std::size_t>(kind)];
}

/// Most children of a branch.
[[nodiscard]] constexpr std::uint32_t bvh_children(BvhNodeKind kind) {
  constexpr std::array<std::uint32_t, 5> children = {2, 4, 6, 8, 8};
  return children[static_cast<std::size_t>(kind)];
}

/// Most primitives that a leaf can list: the records in bytes count them in three bits in unary (8_quantised)
/// and in four bits (6).
[[nodiscard]] constexpr std::uint32_t bvh_largest_leaf(BvhNodeKind kind) {
  constexpr std::array<std::uint32_t, 5> primitives = {64, 64, 15, 64, 3};
  return primitives[static_cast<std::size_t>(kind)];
}

inline constexpr std::uint32_t bvh_most_bins = 64;

struct BvhOptions {
  BvhNodeKind node = BvhNodeKind::eight;
  /// Most primitives of a leaf; a smaller leaf is made where that costs less. From 1 to bvh_largest_leaf.
  std::uint32_t max_objects = 3;
  /// Intervals into which a node's extent is divided along each axis to look for the best split. From 2 to
  /// bvh_most_bins.
  std::uint32_t bins = 32;
  /// Number of host threads that build; 0 stands for all that the computer has. Equal trees come of any
  /// number.
  unsigned threads = 0;
  /// What the build may take of the host's memory.
  sim::MemoryBudget memory{};
};

}  // namespace marti::accel
