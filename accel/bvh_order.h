// The walk of a bounding volume hierarchy in any order of walk_order.h. Hits are those of bvh_walk.h, because
// a hit counts whatever comes before it, and of two at the same distance the primitive of the lower number
// does (watertight.h). Boxes are tested as there, but never on vectors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "accel/bvh.h"
#include "accel/bvh_far.h"
#include "accel/bvh_walk.h"
#include "accel/far_ray.h"
#include "accel/queries.h"
#include "accel/record_order.h"
#include "accel/visitor.h"
#include "accel/waiting_nodes.h"
#include "accel/walk_order.h"

namespace marti::accel {

/// Tests a branch's boxes as walk_bvh does.
template <class Real, class Node>
class NearBoxes {
 public:
  using Float = BoxFloat<Real>;

  NearBoxes(const BvhRay<Float>& ray, const BvhDistance<Real>& distance, const Best<Real>& best)
      : ray_(ray), distance_(distance), limit_(distance.limit(best.t)) {}

  /// The distance beyond which a box holds nothing nearer than a hit at t.
  [[nodiscard]] Float limit(const Real& t) const { return distance_.limit(t); }
  /// The best hit has changed.
  void shorten(const Best<Real>& best) { limit_ = limit(best.t); }
  /// Whether a box that is entered at `in` holds nothing nearer than the best hit.
  [[nodiscard]] bool is_behind(Float in) const { return in > limit_; }
  /// Calls use(in, child) for the children whose boxes the ray meets, the lowest first.
  template <class Use>
  void each_met(const Node& node, const Use& use) const {
    using std::max;
    using std::min;
    const auto planes = planes_of(node, ray_);
    for (std::size_t c = 0; c < node.children(); ++c) {
      const Float in = max(max(planes.near(0, c), planes.near(1, c)), max(planes.near(2, c), Float(0.0F)));
      const Float out = min(min(planes.far(0, c), planes.far(1, c)), min(planes.far(2, c), limit_));
      if (in <= out) {
        use(in, c);
      }
    }
  }

 private:
  const BvhRay<Float>& ray_;
  const BvhDistance<Real>& distance_;
  Float limit_;
};

/// Tests them as walk_bvh_far does.
template <class Real, class Node>
class FarBoxes {
 public:
  using Float = double;

  FarBoxes(const FarRay& far, const BvhSpace& space, const Best<Real>& best) : far_(far), space_(space) {
    shorten(best);
  }
  [[nodiscard]] Float limit(const Real& t) const { return plain(t) + far_.slack; }
  void shorten(const Best<Real>& best) { limit_ = limit(best.t); }
  [[nodiscard]] bool is_behind(Float in) const { return in > limit_; }
  template <class Use>
  void each_met(const Node& node, const Use& use) const {
    for (std::size_t c = 0; c < node.children(); ++c) {
      const scenes::Bounds box = node.box(c);
      const FarSpan span =
          far_.span(space_.center + space_.inverse * box.lo, space_.center + space_.inverse * box.hi);
      if (span.in <= span.out && span.out >= far_.t_min - far_.slack) {
        use(span.in, c);
      }
    }
  }

 private:
  const FarRay& far_;
  const BvhSpace& space_;
  double limit_ = 0.0;
};

/// Fills `met` with the children of a branch whose boxes the ray meets, in the order in which it enters them.
/// Returns how many they are.
template <class Node, class Boxes>
std::size_t met_children(const BvhView<Node>& view, std::uint32_t record, const Boxes& boxes,
                         std::array<BvhWaiting<typename Boxes::Float>, Node::width>& met) {
  const std::uint32_t first = view.first_child(record);
  const Node& node = view.nodes[record];
  std::size_t count = 0;
  boxes.each_met(node, [&](typename Boxes::Float in, std::size_t c) {
    std::size_t at = count++;
    for (; at > 0 && met[at - 1].in > in; --at) {
      met[at] = met[at - 1];
    }
    met[at] = {in, first + static_cast<std::uint32_t>(c), node.child(c)};
  });
  return count;
}

/// Returns use(boxes) with what tests the boxes of branches for the ray; false where it misses the root's
/// box.
template <class Real, class Node, class Use>
bool with_boxes(const BvhView<Node>& view, const Ray& ray, const RaySetup<Real>& setup,
                const Best<Real>& best, const Use& use) {
  if constexpr (!std::is_same_v<Real, float>) {
    const WalkStart<Real> start = start_walk(*view.frame, ray, setup);
    const BvhDistance<Real> distance(view.space, ray, start, setup);
    if (!start.far && distance.usable()) {
      if (!start.hits_root) {
        return false;
      }
      const BvhRay<BoxFloat<Real>> moved = moved_ray(view.space, ray, start, setup);
      return use(NearBoxes<Real, Node>(moved, distance, best));
    }
  }
  const scenes::Bounds& box = view.frame->box;
  if (box.empty()) {
    return false;
  }
  const FarRay far(*view.frame, ray, std::is_same_v<Real, float>);
  return far.may_hit(far.span(box.lo, box.hi), plain(best.t)) &&
         use(FarBoxes<Real, Node>(far, view.space, best));
}

template <bool Any, class Real, class Node, class Boxes, class Visitor>
bool walk_bvh_in_order(const BvhView<Node>& view, WaitingNodes<BvhWaiting<typename Boxes::Float>> waiting,
                       Boxes boxes, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) {
  using Waiting = BvhWaiting<typename Boxes::Float>;
  Waiting now{};
  for (;;) {
    if (now.child.entries == 0) {
      visitor.branch(now.number);
      std::array<Waiting, Node::width> met;
      const std::size_t count = met_children(view, now.child.record, boxes, met);
      if constexpr (SeesEntered<Visitor>) {
        EnteredChildren entered;
        for (std::size_t k = 0; k < count; ++k) {
          entered.add(met[k].number - view.first_child(now.child.record));
        }
        visitor.entered(entered);
      }
      waiting.add(met.data(), count);
    } else {
      if (test_bvh_leaf<Any>(view, now.number, now.child, setup, best, visitor)) {
        return true;
      }
      boxes.shorten(best);
    }
    const std::uint32_t visited = now.number;
    do {
      if (waiting.empty()) {
        return false;
      }
      now = waiting.take(visited);
    } while (boxes.is_behind(now.in));
  }
}

/// A bounding volume hierarchy whose rays take its nodes in a given order; its hits are those of any order.
class OrderedBvh : public Queries<OrderedBvh> {
 public:
  /// Keeps a reference to the tree. `treelet_records`: with WalkOrder::treelet_first, the most node records
  /// of a treelet.
  OrderedBvh(const Bvh& bvh, WalkOrder order, std::uint32_t treelet_records = 0) : bvh_(bvh), order_(order) {
    if (order == WalkOrder::treelet_first) {
      treelet_ = treelets_of(bvh.topology(), false, treelet_records).of_node;
    }
  }

  [[nodiscard]] const TriangleSet& triangles() const { return bvh_.triangles(); }
  [[nodiscard]] const Bvh& bvh() const { return bvh_; }

 private:
  friend class Queries<OrderedBvh>;

  template <bool Any, class Real, class Visitor>
  bool query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
    static_assert(!has_mailboxes<Visitor>);
    return bvh_.with_view([&](const auto& view) {
      return with_boxes(view, ray, setup, best, [&]<class Boxes>(const Boxes& boxes) {
        return walk_bvh_in_order<Any>(view, WaitingNodes<BvhWaiting<typename Boxes::Float>>(order_, treelet_),
                                      boxes, setup, best, visitor);
      });
    });
  }

  const Bvh& bvh_;
  WalkOrder order_;
  std::vector<std::uint32_t> treelet_;  // of each node, where the order rests on it
};

}  // namespace marti::accel
