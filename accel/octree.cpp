#include "accel/octree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "accel/build_memory.h"
#include "accel/parallel.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

constexpr double not_a_triangle = std::numeric_limits<double>::quiet_NaN();
// Up to this ratio, copies of the leaves' triangles (80 bytes an entry) are worth their memory.
constexpr std::uint64_t packed_entries_per_triangle = 16;
constexpr std::uint64_t packed_entries_always = std::uint64_t{1} << 16;
// Nodes that a thread packs in one piece.
constexpr std::size_t nodes_at_once = 4096;

OctreeNode record_of(const Topology& topology, const TopologyNode& node) {
  if (node.leaf) {
    return {node.first, node.count | OctreeNode::leaf_bit};
  }
  OctreeNode record{node.first, 0};
  for (std::uint32_t child = 0; child < 8; ++child) {
    const TopologyNode& below = topology.nodes[node.first + child];
    if (!below.leaf || below.count > 0) {
      record.info |= 1U << child;
    }
  }
  return record;
}

// Whether the leaves' triangles are gathered in packs.
bool has_packs(const Topology& topology, const TriangleSet& triangles) {
#ifdef MARTI_AVX2
  return sim::has_avx2() && (topology.entries.size() <= packed_entries_always ||
                             topology.entries.size() <= packed_entries_per_triangle * triangles.size());
#else
  static_cast<void>(topology);
  static_cast<void>(triangles);
  return false;
#endif
}

std::uint32_t packs_of(const TopologyNode& node) { return node.leaf ? (node.count + 3) / 4 : 0; }

}  // namespace

std::uint64_t Octree::walk_bytes(const Topology& topology, const TriangleSet& triangles) {
  const std::uint64_t records = topology.nodes.size() * sizeof(OctreeNode);
  if (!has_packs(topology, triangles)) {
    return records;
  }
  std::uint64_t packs = 0;
  for (const TopologyNode& node : topology.nodes) {
    packs += packs_of(node);
  }
  return 2 * records + packs * sizeof(TrianglePack);
}

Octree Octree::build(std::shared_ptr<const TriangleSet> triangles, const OctreeOptions& options) {
  sim::ensure(triangles != nullptr, "an octree needs a triangle set, even an empty one");
  check_octree_options(kind_name, options);
  const RootFrame frame = make_frame(*triangles, options.enclose);
  OctreeBuild build = build_octree(*triangles, options, frame);
  return {std::move(triangles), options, frame, std::move(build)};
}

Octree::Octree(std::shared_ptr<const TriangleSet> triangles, const OctreeOptions& options,
               const RootFrame& frame, OctreeBuild build)
    : triangles_(std::move(triangles)),
      options_(options),
      topology_(std::move(build.topology)),
      frame_(frame),
      levels_(std::move(build.levels)),
      cut_(build.cut) {
  pack();
}

void Octree::pack() {
  require_tree(options_.memory, bytes_of(topology_) + walk_bytes(topology_, *triangles_), kind_name);
  const std::size_t count = topology_.nodes.size();
  nodes_.resize(node_offset + count);
  parallel_pieces(count, nodes_at_once, options_.threads, [this](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      nodes_[node_offset + n] = record_of(topology_, topology_.nodes[n]);
    }
  });
  if (!has_packs(topology_, *triangles_)) {
    return;
  }
  packed_nodes_ = nodes_;
  std::uint32_t packs = 0;
  for (std::size_t n = 0; n < count; ++n) {
    if (topology_.nodes[n].leaf) {
      packed_nodes_[node_offset + n].first = packs;
    }
    packs += packs_of(topology_.nodes[n]);
  }
  packs_.resize(packs);
  parallel_pieces(count, nodes_at_once, options_.threads, [this](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (topology_.nodes[n].leaf) {
        pack_leaf(n);
      }
    }
  });
}

void Octree::pack_leaf(std::size_t n) {
  const TopologyNode& node = topology_.nodes[n];
  TrianglePack* pack = packs_.data() + packed_nodes_[node_offset + n].first;
  for (std::uint32_t k = 0; k < node.count; k += 4, ++pack) {
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      const std::uint32_t id = topology_.entries[node.first + std::min(k + lane, node.count - 1)];
      pack->id[lane] = id;
      for (std::size_t c = 0; c < 9; ++c) {
        pack->coordinate[c][lane] = id < triangles_->triangles() ? (*triangles_)[id][c] : not_a_triangle;
      }
    }
  }
}

}  // namespace marti::accel
