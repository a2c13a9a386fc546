#include "studies/frames/refit_work.h"

#include <algorithm>
#include <span>

#include "accel/moved_primitives.h"
#include "accel/topology.h"

namespace marti::studies::frames {

using processors::cost::TreeWork;

namespace {

// A tree, and by nodes of its top level the instance that each is, if it is one.
struct InstancedTree {
  const accel::Topology& topology;
  std::span<const std::uint32_t> instance_of;
  const accel::TriangleSet& triangles;
};

// By node: whether something below it has moved, so that its record holds other boxes or another transform.
// Children have higher numbers than their parents.
std::vector<bool> altered(const InstancedTree& tree, const Moved& moved) {
  std::vector<bool> nodes(tree.topology.nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    const accel::TopologyNode& node = tree.topology.nodes[n];
    bool any = node.instance && moved.instances[tree.instance_of[n]];
    for (std::uint32_t i = node.first; i < node.first + node.count && !any; ++i) {
      any = node.leaf ? moved.primitives[tree.topology.entries[i]] : nodes[i];
    }
    nodes[n] = any;
  }
  return nodes;
}

// By node: whether its record, or its list, is made.
std::vector<bool> made_nodes(const InstancedTree& tree, const Moved& moved, RefitWay way) {
  const std::vector<accel::TopologyNode>& nodes = tree.topology.nodes;
  if (way == RefitWay::rebuild) {
    return std::vector<bool>(nodes.size(), true);
  }
  std::vector<bool> made = altered(tree, moved);
  if (way == RefitWay::refit) {
    return made;
  }
  const std::size_t top = tree.instance_of.size();
  std::fill_n(made.begin(), top, true);
  // The roots of meshes are on one level, which no other node behind the top level's is on.
  for (std::size_t n = top + 1; n < nodes.size(); ++n) {
    made[n] = nodes[n].level == nodes[top].level ? made[n] : made[n - 1];
  }
  return made;
}

// By node: how many of the branches that are made lie one below the other, it among them.
std::vector<std::uint32_t> branches_below(const accel::Topology& topology, const std::vector<bool>& made) {
  std::vector<std::uint32_t> below(made.size());
  for (std::size_t n = made.size(); n-- > 0;) {
    const accel::TopologyNode& node = topology.nodes[n];
    if (node.leaf || !made[n]) {
      continue;
    }
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      below[n] = std::max(below[n], below[child]);
    }
    below[n] += node.instance ? 0 : 1;
  }
  return below;
}

TreeWork work_of_nodes(const InstancedTree& tree, const Moved& moved, RefitWay way) {
  TreeWork work;
  work.refits = way == RefitWay::refit;
  const std::vector<bool> made = made_nodes(tree, moved, way);
  for (std::size_t n = 0; n < made.size(); ++n) {
    const accel::TopologyNode& node = tree.topology.nodes[n];
    if (!made[n]) {
      continue;
    }
    if (node.leaf) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        ++(tree.topology.entries[i] < tree.triangles.triangles() ? work.triangles : work.quadrics);
      }
    } else {
      ++(node.instance ? work.instances : work.branches);
    }
    // No record holds the root's own box.
    work.merged += work.refits && n > 0 && node.count > 0 ? node.count - 1 : 0;
  }
  work.levels = work.refits ? branches_below(tree.topology, made)[0] : 0;
  return work;
}

}  // namespace

Moved moved_between(const accel::TriangleSet* before, const accel::TriangleSet& after) {
  Moved moved;
  moved.primitives.assign(after.size(), before == nullptr);
  moved.instances.assign(after.instances().size(), before == nullptr);
  if (before == nullptr) {
    return moved;
  }
  for (const std::uint32_t id : accel::moved_primitives(*before, after)) {
    moved.primitives[id] = true;
  }
  for (std::size_t i = 0; i < moved.instances.size(); ++i) {
    const scenes::InstancePlace& now = after.instances()[i];
    const scenes::InstancePlace& then = before->instances()[i];
    moved.instances[i] = now.linear != then.linear || now.shift != then.shift;
    const accel::PrimitiveRange& mesh = after.meshes()[now.mesh];
    const auto first = moved.primitives.begin() + mesh.first;
    moved.count += moved.instances[i]
                       ? mesh.count
                       : static_cast<std::uint64_t>(std::count(first, first + mesh.count, true));
  }
  if (after.instances().empty()) {
    moved.count = static_cast<std::uint64_t>(std::ranges::count(moved.primitives, true));
  }
  return moved;
}

TreeWork work_of(const accel::Bvh& tree, const Moved& moved, RefitWay way) {
  TreeWork work = work_of_nodes({tree.topology(), {}, tree.triangles()}, moved, way);
  work.build = tree.work();
  return work;
}

TreeWork work_of(const accel::TwoLevelBvh& tree, const Moved& moved, RefitWay way) {
  TreeWork work = work_of_nodes({tree.topology(), tree.instance_of(), tree.triangles()}, moved, way);
  work.build = tree.work();
  return work;
}

}  // namespace marti::studies::frames
