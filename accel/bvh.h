// The bounding volume hierarchy: every primitive is in exactly one leaf, and a branch has a box around each
// of its children. Built as a binary tree by the surface area heuristic (bvh_build.h), whose nodes are then
// merged into nodes with more children; bvh_walk.h says how it is walked, and why it misses no hit.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "accel/bvh_box.h"
#include "accel/bvh_build.h"
#include "accel/bvh_nodes.h"
#include "accel/bvh_options.h"
#include "accel/bvh_ray.h"
#include "accel/bvh_walk.h"
#include "accel/bvh_work.h"
#include "accel/mailbox.h"
#include "accel/queries.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/traversal.h"
#include "accel/triangles.h"
#include "sim/error.h"
#include "sim/large_pages.h"

namespace marti::accel {

class Bvh : public Queries<Bvh> {
 public:
  static constexpr std::string_view kind_name = "bvh";

  /// Builds the whole tree, on options.threads host threads. Throws UserError when an option is out of range.
  /// Unless there are no primitives, the root is a branch.
  [[nodiscard]] static Bvh build(std::shared_ptr<const TriangleSet> triangles,
                                 const BvhOptions& options = {});

  /// A tree over a part of the set, which `frame` encloses: a mesh of which a two-level tree has instances.
  [[nodiscard]] static Bvh build(std::shared_ptr<const TriangleSet> triangles, PrimitiveRange range,
                                 const RootFrame& frame, const BvhOptions& options);

  /// The same nodes over primitives of which some have moved, with boxes around what is below them now
  /// (refitting: Lauterbach, Yoon, Tuft, Manocha, "RT-DEFORM", IEEE Symposium on Interactive Ray Tracing
  /// 2006). Hits are those of a tree that is built for them; walks take longer the more they have moved.
  /// Throws UserError when there are not as many.
  [[nodiscard]] Bvh refitted(std::shared_ptr<const TriangleSet> moved) const;

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const Bvh& bvh() const { return *this; }
  [[nodiscard]] const BvhOptions& options() const { return options_; }
  [[nodiscard]] const scenes::Bounds& bounds() const { return frame_.box; }
  [[nodiscard]] Traversal traversal() const { return traversal_of(options_.node); }
  /// The root's number: 0, but of a mesh of a two-level tree.
  [[nodiscard]] std::uint32_t root() const { return root_; }

  /// The expected cost of a random ray that meets the root's box: the sum over the branches of the chance to
  /// meet their boxes, plus that over the leaves times their numbers of primitives. A chance is the surface
  /// area of a box, as the records hold it, over that of the root. The cost is 0 for a scene without
  /// primitives and for one without area.
  [[nodiscard]] double sah_cost() const;

  /// Of building the tree; none where it was refitted.
  [[nodiscard]] const BvhWork& work() const { return work_; }

  /// Bytes of host memory for the walks' own records, without the topology.
  [[nodiscard]] std::uint64_t walk_bytes() const;

 private:
  template <class Real>
  friend class BvhMeets;    // bvh_meets.h
  friend class OrderedBvh;  // bvh_order.h
  friend class TwoLevelBvh;
  friend class Queries<Bvh>;
  Bvh() = default;

  void number_nodes(const BvhBinaryTree& binary);
  [[nodiscard]] Bvh refitted(std::shared_ptr<const TriangleSet> moved, const RootFrame& frame) const;
  void set_space();
  void fit_boxes();
  void order_records();
  /// From the topology and `boxes_`.
  void make_all_records();
  template <class Node>
  void make_records(sim::LargeVector<Node>& records);
  void join(Topology& whole, unsigned level);
  void leave(const Topology& whole, std::uint32_t nodes);

  template <class Node>
  [[nodiscard]] BvhView<Node> view(const sim::LargeVector<Node>& records) const {
    return {.nodes = records.data(),
            .first = first_.data(),
            .primitives = primitives_.data(),
            .triangles = triangles_.get(),
            .frame = &frame_,
            .space = space_,
            .root = root_,
            .vectors = vectors_};
  }
  /// Calls `f` with the view of this tree's kind of records.
  template <class F>
  decltype(auto) with_view(F&& f) const {
    return with_records(*this, [&](const auto& records) { return f(view(records)); });
  }
  template <class Tree, class F>
  static decltype(auto) with_records(Tree& tree, F&& f) {
    switch (tree.options_.node) {
      case BvhNodeKind::two:
        return f(tree.two_);
      case BvhNodeKind::four:
        return f(tree.four_);
      case BvhNodeKind::six:
        return f(tree.six_);
      case BvhNodeKind::eight:
        return f(tree.eight_);
      case BvhNodeKind::eight_quantised:
        break;
    }
    return f(tree.quantised_);
  }

  template <bool Any, class Real, class Visitor>
  bool query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
    begin_query(visitor);
    return with_view([&](const auto& view) { return query_bvh<Any>(view, ray, setup, best, visitor); });
  }

  std::shared_ptr<const TriangleSet> triangles_;
  BvhOptions options_;
  RootFrame frame_;
  BvhSpace space_;
  Topology topology_;
  BvhWork work_;
  std::vector<BvhBox> boxes_;         ///< by node number; only while the tree is built
  std::vector<std::uint32_t> first_;  ///< see BvhView
  std::vector<BvhPrimitive> primitives_;
  std::uint32_t branches_ = 0;
  std::uint32_t root_ = 0;  ///< its number
  bool vectors_ = false;    ///< walks on vectors can be used
  /// By node number: a branch's record, a leaf's first BvhPrimitive; only while the tree is built.
  std::vector<std::uint32_t> place_;
  sim::LargeVector<BvhNode<2>> two_;
  sim::LargeVector<BvhNode<4>> four_;
  sim::LargeVector<BvhSixNode> six_;
  sim::LargeVector<BvhNode<8>> eight_;
  sim::LargeVector<BvhQuantisedNode> quantised_;
};

}  // namespace marti::accel
