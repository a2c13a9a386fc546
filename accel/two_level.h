// Bounding volume hierarchies on two levels: one over each mesh, in the mesh's own coordinates, and one over
// the boxes of all instances, as the acceleration structures of today's units (Vulkan 1.3, chapter
// "Acceleration Structures": top-level and bottom-level).
//
// In the topology, an instance is a branch with one child, the root of its mesh, and marked as an instance;
// its record is the transform. Instances of one mesh share that child, so that the topology is no tree below
// instances. The nodes of the top level come first, then those of mesh after mesh. The roots of all meshes
// are one level below the deepest instance.
//
// Why no hit is missed. In a mesh's coordinates the reasons of bvh_walk.h hold; its rays often begin many
// sizes of the mesh away, and its frame is made for a reach of 2^14 diagonals. Of the top level, boxes are
// enlarged by the largest stretch of an instance times 2^-42 of the scene's diagonal, which is more than
// what a ray from within 64 diagonals is off (instance.h); for rays from farther away the slow walk enlarges
// them in proportion to the distance.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "accel/bvh.h"
#include "accel/instance.h"
#include "accel/mailbox.h"
#include "accel/queries.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"

namespace marti::accel {

class TwoLevelBvh;

/// The top level as walks see it, whose leaves are instances.
template <class Node>
struct BvhTopView : BvhView<Node> {
  const TwoLevelBvh* whole = nullptr;
  const Ray* ray = nullptr;  ///< in the scene's coordinates
};

class TwoLevelBvh : public Queries<TwoLevelBvh> {
 public:
  static constexpr std::string_view kind_name = Bvh::kind_name;

  /// Over the instances of the set. The ids of hits are those of InstancePlace::first. Throws UserError for
  /// transforms that Instance refuses, and for options out of range; these are those of a mesh's tree.
  [[nodiscard]] static TwoLevelBvh build(std::shared_ptr<const TriangleSet> triangles,
                                         const BvhOptions& options = {});

  /// What is done to the trees of which something has moved: the top level's, and those of meshes whose
  /// primitives are elsewhere in the mesh's coordinates.
  enum class Update : std::uint8_t { rebuild, refit };
  /// The tree over the same meshes and instances after some of both have moved; trees of meshes that have not
  /// changed are kept. With Update::rebuild it equals a tree that is built from nothing. Throws UserError
  /// when there are other meshes or instances.
  [[nodiscard]] TwoLevelBvh moved(std::shared_ptr<const TriangleSet> after, Update update) const;

  [[nodiscard]] const Topology& topology() const { return topology_; }
  /// By nodes of the top level, which are the first ones of the topology: the instance that a node is, if it
  /// is one.
  [[nodiscard]] const std::vector<std::uint32_t>& instance_of() const { return instance_of_; }
  /// The primitives of all meshes, in coordinates of their own.
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  /// In the scene's coordinates.
  [[nodiscard]] const scenes::Bounds& bounds() const { return top_.bounds(); }
  [[nodiscard]] Traversal traversal() const { return top_.traversal(); }
  [[nodiscard]] const std::vector<Instance>& instances() const { return instances_; }
  /// Of building the top level and the trees of meshes that were built for this tree, none of them refitted.
  [[nodiscard]] const BvhWork& work() const { return work_; }
  /// Bytes of host memory for the walks' own records, without the topology.
  [[nodiscard]] std::uint64_t walk_bytes() const;

 private:
  friend class Queries<TwoLevelBvh>;
  template <bool Any, class Real, class Node, class Visitor>
  friend bool test_bvh_leaf(const BvhTopView<Node>& view, std::uint32_t number, const BvhChild& leaf,
                            const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor);
  TwoLevelBvh() = default;
  /// Makes the instances of meshes with these boxes. Returns a triangle for each one's box, of which only the
  /// box is used.
  [[nodiscard]] std::shared_ptr<const TriangleSet> place_instances(const std::vector<scenes::Bounds>& boxes);
  /// Makes one topology of those of the top level and the meshes, and adds up their work.
  void join_trees();

  template <bool Any, class Real, class Visitor>
  bool query(const Ray& ray, const RaySetup<Real>& setup, Best<Real>& best, Visitor& visitor) const {
    return top_.with_view([&]<class Node>(const BvhView<Node>& view) {
      BvhTopView<Node> top{view, this, &ray};
      top.far_rounding = far_rounding_;
      return query_bvh<Any>(top, ray, setup, best, visitor);
    });
  }

  template <bool Any, class Real, class Visitor>
  bool enter(std::uint32_t number, const Ray& ray, Best<Real>& best, Visitor& visitor) const {
    const Instance& instance = instances_[instance_of_[number]];
    visitor.transform(number);
    if constexpr (SeesEntered<Visitor>) {
      EnteredChildren root;
      root.add(0);
      visitor.entered(root);
    }
    // A primitive that another instance of the mesh has tested is elsewhere here.
    begin_query(visitor);
    const Ray local = instance.in_mesh<Real>(ray);
    const RaySetup<Real> setup(local);
    best.first = instance.first();
    return meshes_[instance.mesh()].with_view(
        [&](const auto& view) { return query_bvh<Any>(view, local, setup, best, visitor); });
  }

  std::shared_ptr<const TriangleSet> triangles_;
  BvhOptions options_;  ///< of the meshes' trees
  Bvh top_;             ///< over a triangle for each instance's box, of which only the box is used
  std::vector<Bvh> meshes_;
  std::vector<Instance> instances_;
  std::vector<std::uint32_t> instance_of_;  ///< by number of a node of the top level
  double far_rounding_ = 1.0;
  BvhWork work_;
  Topology topology_;
};

/// An instance in the place of a leaf.
template <bool Any, class Real, class Node, class Visitor>
inline bool test_bvh_leaf(const BvhTopView<Node>& view, std::uint32_t number, const BvhChild& /*leaf*/,
                          const RaySetup<Real>& /*setup*/, Best<Real>& best, Visitor& visitor) {
  return view.whole->template enter<Any>(number, *view.ray, best, visitor);
}

}  // namespace marti::accel
