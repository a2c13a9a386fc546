// Rays that several lanes of a warp trace together (docs/internals/rt-unit.md, Lanes that help each other).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "accel/waiting_nodes.h"

namespace marti::processors::simt {

/// Ranks of what a ray meets (accel/bvh_meets.h) begin with 1 here: no box is in front of a hit of rank 0.
inline constexpr std::uint32_t no_hit = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint32_t hit_that_ends = 0;  ///< of a shadow ray

/// A node that a ray has entered.
struct SharedEntry {
  std::uint32_t rank = 0;
  std::uint32_t number = 0;  ///< of the node
  const std::uint32_t* words = nullptr;
};

struct SharedRay {
  const std::uint32_t* words = nullptr;  ///< what it meets
  bool shadow = false;
  std::uint32_t best = no_hit;  ///< rank of the nearest hit that all of its lanes know
  std::uint32_t lanes = 0;      ///< that have an entry or a test of it
};

struct SharedLane {
  SharedLane(accel::WalkOrder order, std::span<const std::uint32_t> treelets) : waiting(order, treelets) {}

  std::size_t ray = 0;          ///< that it works for: the place of the lane which it is of
  std::uint32_t best = no_hit;  ///< rank of the nearest hit that the lane has found itself
  std::uint32_t visited = 0;    ///< the node visited last
  accel::WaitingNodes<SharedEntry> waiting;
  const std::uint32_t* branch = nullptr;  ///< the words of a branch whose test has not ended
  const std::uint32_t* hits = nullptr;    ///< of the leaf that it visits, those of primitives not yet tested
  const std::uint32_t* hits_end = nullptr;
  std::uint32_t tested = 0;  ///< primitives of this leaf
  bool tests = false;        ///< one of them is the record that the lane wants or has
};

}  // namespace marti::processors::simt
