// A structure's tree without its geometry: what timing needs to turn "visit node n" and "test the objects of
// leaf n" into addresses.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace marti::accel {

/// A leaf holds object references; a branch holds children with consecutive node numbers.
struct TopologyNode {
  std::uint32_t first = 0;  ///< branch: number of the first child; leaf: index of its first entry
  std::uint32_t count = 0;  ///< branch: number of children; leaf: number of entries
  std::uint8_t level = 1;   ///< the root is level 1
  bool leaf = true;
  bool instance = false;  ///< a branch whose record is the transform to its one child, the root of a mesh

  bool operator==(const TopologyNode&) const = default;
};

/// The work of making a node's children when the tree was built.
struct SplitWork {
  std::uint32_t listed = 0;    ///< number of triangles that the node listed
  std::uint32_t overlaps = 0;  ///< triangle against box tests run to sort them into children; 0 for a leaf

  bool operator==(const SplitWork&) const = default;
};

/// Nodes in breadth-first order (node 0 is the root); entries are primitive ids, leaf by leaf in node
/// order, ascending within a leaf. Where instances are kept (two_level.h), an instance is a branch with one
/// child, the root of its mesh, which is below all instances of the mesh.
struct Topology {
  std::vector<TopologyNode> nodes;
  std::vector<std::uint32_t> entries;
  /// One entry for each node of a tree; empty for structures that are not built by splitting nodes.
  std::vector<SplitWork> work;

  bool operator==(const Topology&) const = default;
};

/// Whether instances are kept: then some nodes may be below several branches.
[[nodiscard]] inline bool has_instances(const Topology& topology) {
  return std::ranges::any_of(topology.nodes, &TopologyNode::instance);
}

/// Bytes of host memory that the topology takes.
[[nodiscard]] inline std::uint64_t bytes_of(const Topology& topology) {
  return topology.nodes.size() * sizeof(TopologyNode) + topology.entries.size() * sizeof(std::uint32_t) +
         topology.work.size() * sizeof(SplitWork);
}

}  // namespace marti::accel
