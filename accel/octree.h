// The octree: built breadth-first, split at the centre of every axis, walked by the HERO algorithm.
//
// Why it finds every hit that brute force finds, bit for bit, although all its arithmetic is rounded
// (u = 2^-53, D the length of the root box's diagonal):
//  1. A cell lists every triangle that meets the cell enlarged on all sides by
//       delta = 2^-40 D + 8 ulp(largest coordinate),
//     and the root box reaches 192 delta beyond the triangles (2 would do).
//  2. An accepted hit at t means that the point of the ray at t lies within 2^-41 D of the triangle
//     (watertight.h), given an origin within 128 D.
//  3. The walk cuts the ray's parameters within the root into pieces without gaps and gives each to one
//     cell. By rounding (three operations for a root plane, one for each level's average, each within u of
//     a value below 128 D) a piece may be given to the neighbour across a plane, but then the ray is within
//     24 * 128 u D < 2^-41 D of that plane. So the cell a hit's parameter is given to lists the triangle.
//  4. Cells are left out only when they begin more than 4 delta (as a distance along the ray) beyond the
//     best hit so far, and a hit is never refused for lying outside the cell at hand.
//  Rays that come from farther away, or whose direction's largest component is beyond 2^500 or below
//  2^-500, take a slower walk that tests the boxes of all children, enlarged by the ray's own error.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/octree_build.h"
#include "accel/octree_nodes.h"
#include "accel/octree_options.h"
#include "accel/octree_walk.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "scenes/scene.h"
#include "sim/large_pages.h"

namespace marti::accel {

class Octree {
 public:
  static constexpr std::string_view kind_name = "octree";

  /// Builds the whole tree, on options.threads host threads. Throws UserError when an option is out of range.
  ///
  /// A node with more than max_objects triangles nevertheless remains a leaf when
  ///  - it is at max_level,
  ///  - a child would be thinner than 8 delta on some axis, or the centre not strictly inside,
  ///  - splitting would separate nothing: two or more children list all its triangles and the others
  ///    none (so that coincident triangles do not multiply), or
  /// - max_entries is reached, or 2^28 nodes (a work log cannot number more).
  [[nodiscard]] static Octree build(std::shared_ptr<const TriangleSet> triangles,
                                    const OctreeOptions& options = {});

  /// A tree over `triangles` that was built elsewhere, as build_octree would build it (octree_update.h).
  Octree(std::shared_ptr<const TriangleSet> triangles, const OctreeOptions& options, const RootFrame& frame,
         OctreeBuild build);

  [[nodiscard]] const Topology& topology() const { return topology_; }
  [[nodiscard]] const TriangleSet& triangles() const { return *triangles_; }
  [[nodiscard]] const OctreeOptions& options() const { return options_; }
  /// The root box: the tight box of the triangles (and of OctreeOptions::enclose) enlarged by 192 delta, and
  /// at least D / 4096 thick on every axis (it grows upwards, so that a flat scene does not lie in a
  /// mid-plane). Empty without triangles.
  [[nodiscard]] const scenes::Bounds& bounds() const { return frame_.box; }
  /// By how much cells are enlarged when triangles are sorted into them; see above.
  [[nodiscard]] double delta() const { return frame_.delta; }
  [[nodiscard]] const RootFrame& frame() const { return frame_; }
  /// Whether max_entries, or 2^28 nodes, kept a node from being split.
  [[nodiscard]] bool cut() const { return cut_; }
  /// levels()[i] is level i + 1; as many as the tree has.
  [[nodiscard]] const std::vector<LevelStatistics>& levels() const { return levels_; }

  /// Bytes of host memory for the walks' own records of a tree, without its topology.
  [[nodiscard]] static std::uint64_t walk_bytes(const Topology& topology, const TriangleSet& triangles);

  /// The nearest hit. Real is the scalar of the arithmetic (double, Counted to count operations, or float for
  /// comparison).
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

 private:
  friend class CutOctree;  // a further walk, octree_cut.h
  [[nodiscard]] OctreeView view() const {
    return {nodes_.data() + node_offset,
            packed_nodes_.empty() ? nullptr : packed_nodes_.data() + node_offset,
            packs_.data(),
            topology_.entries.data(),
            triangles_.get(),
            &frame_};
  }
  void pack();
  void pack_leaf(std::size_t n);

  std::shared_ptr<const TriangleSet> triangles_;
  OctreeOptions options_;
  Topology topology_;
  RootFrame frame_;
  std::vector<LevelStatistics> levels_;
  bool cut_ = false;
  sim::LargeVector<OctreeNode> nodes_;
  sim::LargeVector<OctreeNode> packed_nodes_;
  sim::LargeVector<TrianglePack> packs_;
};

}  // namespace marti::accel
