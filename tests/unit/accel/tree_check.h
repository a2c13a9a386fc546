// Octrees compared with one another, and with one built the plain way.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "accel/octree.h"
#include "accel/octree_build.h"
#include "accel/octree_sort.h"
#include "accel/topology.h"

namespace marti::tests {

inline bool same_nodes(const accel::Topology& a, const accel::Topology& b) {
  return a.nodes == b.nodes && a.entries == b.entries;
}

/// A queue of nodes, one split after the other: the definition of the tree.
inline accel::Topology plain_build(const accel::TriangleSet& triangles, const accel::OctreeOptions& options) {
  struct Waiting {
    accel::OctreeCell cell;
    std::vector<std::uint32_t> list;
  };
  const accel::RootFrame frame = accel::make_frame(triangles, options.enclose);
  accel::Topology topology;
  std::vector<Waiting> queue(1);
  for (std::uint32_t id = 0; id < triangles.size(); ++id) {
    queue[0].list.push_back(id);
  }
  std::uint64_t listed = triangles.size();
  for (std::size_t n = 0; n < queue.size(); ++n) {
    const accel::OctreeCell cell = queue[n].cell;
    const std::vector<std::uint32_t> list = queue[n].list;
    const auto level = static_cast<std::uint8_t>(cell.level);
    const auto count = static_cast<std::uint32_t>(list.size());
    accel::SortedChildren sorted;
    bool split = list.size() > options.max_objects && listed < options.max_entries &&
                 accel::level_splits(frame, options.max_level, cell.level);
    if (split) {
      accel::sort_into_children(triangles, frame, cell, list, sorted);
      split = !accel::separates_nothing(sorted, list.size());
    }
    if (!split) {
      topology.nodes.push_back({static_cast<std::uint32_t>(topology.entries.size()), count, level, true});
      topology.work.push_back({count, 0});
      topology.entries.insert(topology.entries.end(), list.begin(), list.end());
      continue;
    }
    topology.nodes.push_back({static_cast<std::uint32_t>(queue.size()), 8, level, false});
    topology.work.push_back({count, sorted.overlaps});
    listed -= list.size();
    for (std::uint32_t child = 0; child < 8; ++child) {
      listed += sorted.lists[child].size();
      queue.push_back({cell.child(child), sorted.lists[child]});
    }
  }
  return topology;
}

}  // namespace marti::tests
