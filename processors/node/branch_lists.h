// The primitives that a branch listed before it was split: those of the leaves below it.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "accel/topology.h"

namespace marti::processors::node {

/// Each list is built when it is first asked for, and kept. An object belongs to one thread.
class BranchLists {
 public:
  explicit BranchLists(const accel::Topology& topology) : topology_(topology) {}

  /// The list, ascending and without repetition. It lacks a primitive that the branch listed and none of its
  /// leaves lists, which only the rounding of an overlap test can cause.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t branch);

 private:
  const accel::Topology& topology_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> lists_;
};

}  // namespace marti::processors::node
