// The octree that is built while it is used (McNeill, Shah, Hebert, Lister, Grimsdale, "Performance of Space
// Subdivision Techniques in Ray Tracing", Computer Graphics Forum 11(4), 1992): down to an initial level
// before the first ray, and below it node by node, each when the first ray reaches it. Nodes are branches
// (B), leaves (L) or still to be subdivided (P).
//
// Any number of threads may use it at once. The first one that reaches a P node subdivides it, exactly once;
// others that reach it meanwhile wait. A subdivided node and its children never move or change, so the rest
// of a walk is that of a finished tree and takes no lock.
//
// It is the octree of octree.h, divided by the same rules, so its hits are the same, bit for bit, and when
// fully expanded it is the same tree node by node, in whatever order it grew. For that reason it never stops
// at a limit that depends on the order: a query after which the tree would list max_entries triangles or more
// throws UserError. (An octree built at once keeps such a node as a leaf.)
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "accel/lazy_nodes.h"
#include "accel/octree.h"
#include "accel/octree_build.h"
#include "accel/octree_walk.h"
#include "accel/ray.h"
#include "accel/triangles.h"

namespace marti::accel {

struct LazyOctreeOptions {
  OctreeOptions tree;
  /// How far it is built before the first ray. The default is fully, which leaves nothing to do.
  BuildLimit initial;
};

/// How much of a lazy octree has been built.
struct LazyOctreeState {
  struct Level {
    std::uint64_t branches = 0;  ///< B
    std::uint64_t leaves = 0;    ///< L
    std::uint64_t pending = 0;   ///< P nodes
    std::uint64_t leaf_entries = 0;
    std::uint64_t pending_entries = 0;

    [[nodiscard]] std::uint64_t nodes() const { return branches + leaves + pending; }
  };
  std::vector<Level> levels;  ///< [level - 1]
  Level all;                  ///< their sum
  /// Bytes of all nodes, B, L and P, and of the places (cells) of P nodes.
  std::uint64_t node_bytes = 0;
  /// Bytes of the lists of L and P nodes, 4 for each triangle listed.
  std::uint64_t list_bytes = 0;
  /// P nodes that rays have subdivided (or that became leaves, because dividing them separates nothing).
  std::uint64_t subdivided = 0;
};

class LazyOctree {
 public:
  static constexpr std::string_view kind_name = "lazy_octree";

  /// Builds to the initial level. Throws UserError when an option is out of range or max_entries reached.
  [[nodiscard]] static LazyOctree build(std::shared_ptr<const TriangleSet> triangles,
                                        const LazyOctreeOptions& options = {});

  /// Continues a tree that was built or updated elsewhere; the nodes in build.unsplit are its P nodes. Throws
  /// UserError when build.cut.
  LazyOctree(std::shared_ptr<const TriangleSet> triangles, const OctreeOptions& options,
             const RootFrame& frame, const OctreeBuild& build);
  LazyOctree(LazyOctree&&) noexcept;
  LazyOctree& operator=(LazyOctree&&) noexcept;
  ~LazyOctree();

  [[nodiscard]] const TriangleSet& triangles() const;
  [[nodiscard]] const OctreeOptions& options() const;
  [[nodiscard]] const scenes::Bounds& bounds() const;
  /// Throws UserError: the topology changes while rays are traced, so no work log can refer to it.
  [[nodiscard]] const Topology& topology() const;

  /// The nearest hit. The visitor is told node numbers, which follow the order in which nodes were made and
  /// so depend on the threads. Throws UserError at max_entries (see above).
  template <class Real = double, class Visitor>
  [[nodiscard]] Hit closest(const Ray& ray, Visitor& visitor) const {
    return octree_closest<Real>(view(), ray, visitor);
  }

  /// Whether anything is hit; ends at the first hit.
  template <class Real = double, class Visitor>
  [[nodiscard]] bool occluded(const Ray& ray, Visitor& visitor) const {
    return octree_occluded<Real>(view(), ray, visitor);
  }

  /// As Queries::nearest().
  template <class Real = double, class Visitor>
  void nearest(const Ray& ray, NearestGaussians& buffer, Visitor& visitor) const {
    octree_nearest<Real>(view(), ray, buffer, visitor);
  }

  /// Subdivides a node of pending(), unless that was done since, as a ray that reaches it does.
  void subdivide(std::uint32_t node) const;
  /// Subdivides until no P node is left. Throws UserError at max_entries (see above).
  void expand() const;

  // The functions below must not run while rays are traced.

  [[nodiscard]] LazyOctreeState state() const;
  /// The numbers of the P nodes, ascending.
  [[nodiscard]] std::vector<std::uint32_t> pending() const;
  /// The present tree, numbered breadth-first: equal trees give equal snapshots, in whatever order they grew.
  /// P nodes are leaves that are listed in `unsplit`. Topology::work is empty.
  [[nodiscard]] OctreeBuild snapshot() const;

 private:
  struct State {
    std::shared_ptr<const TriangleSet> triangles;
    OctreeOptions options;
    RootFrame frame;
    LazyNodes nodes;
    std::atomic<std::uint64_t> listed{0};  ///< entries of the lists of L and P nodes
    std::atomic<std::uint64_t> subdivided{0};
  };

  struct View {
    struct Record {
      std::uint32_t first;
      std::uint32_t info;
      const std::uint32_t* list;
      [[nodiscard]] bool leaf() const { return (info & OctreeNode::leaf_bit) != 0; }
      [[nodiscard]] std::uint32_t entries() const { return info & ~OctreeNode::leaf_bit; }
    };
    static constexpr bool has_packs = false;

    [[nodiscard]] Record node(std::uint32_t n) const {
      LazyNode& node = state->nodes[n];
      std::uint32_t info = node.info.load(std::memory_order_acquire);
      if (LazyNode::is_pending(info)) [[unlikely]] {
        info = resolve(*state, node);
      }
      return {node.first, info, node.list};
    }
    [[nodiscard]] static const std::uint32_t* list(const Record& record) { return record.list; }

    State* state;
    const TriangleSet* triangles;
    const RootFrame* frame;
  };

  [[nodiscard]] View view() const { return {state_.get(), state_->triangles.get(), &state_->frame}; }
  /// Subdivides a pending node or waits until another thread has; returns the node's new `info`.
  static std::uint32_t resolve(State& state, LazyNode& node);
  static std::uint32_t divide(State& state, LazyNode& node);
  static void place_pending(LazyNode& node, const OctreeCell& cell, std::span<const std::uint32_t> list);
  static void place_leaf(State& state, LazyNode& node, std::span<const std::uint32_t> list);

  std::unique_ptr<State> state_;
};

}  // namespace marti::accel
