// Testing a leaf's list, for structures whose leaves are read straight from the topology.
#pragma once

#include <cstdint>

#include "accel/intersect.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/watertight.h"

namespace marti::accel {

/// Tests the primitives of leaf `node` in list order and tells the visitor. True when an occlusion query
/// (`Any`) found its hit.
template <bool Any, class Real, class Visitor>
bool test_list(const Topology& topology, const TriangleSet& triangles, std::uint32_t node,
               const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  const TopologyNode& record = topology.nodes[node];
  for (std::uint32_t k = 0; k < record.count; ++k) {
    const std::uint32_t id = topology.entries[record.first + k];
    const bool hit = intersect_primitive(setup, triangles, id, best);
    if constexpr (Any) {
      if (hit) {
        visitor.leaf(node, k + 1, record.count);
        return true;
      }
    }
  }
  visitor.leaf(node, record.count, record.count);
  return false;
}

}  // namespace marti::accel
