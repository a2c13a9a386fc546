// The interface through which structures are exchangeable.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "accel/brute_force.h"
#include "accel/bsp.h"
#include "accel/bvh.h"
#include "accel/grid.h"
#include "accel/grid_match.h"
#include "accel/lazy_octree.h"
#include "accel/octree.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/traversal.h"
#include "accel/triangles.h"
#include "accel/two_level.h"
#include "sim/error.h"

namespace marti::accel {

/// A built structure over one triangle set. Immutable (the lazy octree appears so), hence any number of
/// threads may use it. All kinds give the same hits, bit for bit.
class Structure {
 public:
  Structure() = default;
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;
  virtual ~Structure() = default;

  [[nodiscard]] virtual std::string_view kind() const = 0;
  [[nodiscard]] virtual const TriangleSet& triangles() const = 0;
  [[nodiscard]] virtual const Topology& topology() const = 0;
  /// The box outside which no ray is followed; empty without triangles.
  [[nodiscard]] virtual const scenes::Bounds& bounds() const = 0;
  /// The nearest hit.
  [[nodiscard]] virtual Hit closest(const Ray& ray) const = 0;
  /// Whether anything is hit.
  [[nodiscard]] virtual bool occluded(const Ray& ray) const = 0;
};

/// A concrete structure behind the interface.
template <class Concrete>
class StructureOf final : public Structure {
 public:
  explicit StructureOf(Concrete concrete) : concrete_(std::move(concrete)) {}

  [[nodiscard]] std::string_view kind() const override { return Concrete::kind_name; }
  [[nodiscard]] const TriangleSet& triangles() const override { return concrete_.triangles(); }
  [[nodiscard]] const Topology& topology() const override { return concrete_.topology(); }
  [[nodiscard]] const scenes::Bounds& bounds() const override { return concrete_.bounds(); }
  [[nodiscard]] Hit closest(const Ray& ray) const override {
    NullVisitor visitor;
    return concrete_.closest(ray, visitor);
  }
  [[nodiscard]] bool occluded(const Ray& ray) const override {
    NullVisitor visitor;
    return concrete_.occluded(ray, visitor);
  }
  [[nodiscard]] const Concrete& concrete() const { return concrete_; }

 private:
  Concrete concrete_;
};

/// Options of every kind; each kind reads its own.
struct StructureOptions {
  OctreeOptions octree;
  BspOptions bsp;
  GridOptions grid;
  BvhOptions bvh;
  /// If not density: an octree with the options above is built to measure it, and then deleted.
  GridMatch grid_match = GridMatch::density;
};

/// The kinds that make_structure accepts: "octree", "bsp", "grid", "bvh" and "none" (brute
/// force).
[[nodiscard]] std::span<const std::string_view> structure_kinds();

/// Builds a structure; a bvh of a set with instances has two levels (two_level.h). Throws UserError for an
/// unknown kind, an option out of range, and instances in another structure.
[[nodiscard]] std::unique_ptr<Structure> make_structure(std::string_view kind,
                                                        std::shared_ptr<const TriangleSet> triangles,
                                                        const StructureOptions& options = {});

/// A lazy octree behind the interface. It is not a kind of make_structure, because it cannot be recorded, and
/// two of them differ when they traced different rays. Throws UserError for an option out of range.
[[nodiscard]] std::unique_ptr<Structure> make_lazy_octree(std::shared_ptr<const TriangleSet> triangles,
                                                          const LazyOctreeOptions& options = {});
/// Approximate bytes of host memory that the structure takes, without its triangles.
[[nodiscard]] std::uint64_t host_bytes(const Structure& structure);

/// The walk that the structure's queries take.
[[nodiscard]] Traversal traversal_of(const Structure& structure);

/// Calls `f` with the concrete structure (const Octree&, and so on), so that the code of `f` is compiled for
/// each and the traversal is inlined.
template <class F>
decltype(auto) visit_structure(const Structure& structure, F&& f) {
  if (const auto* octree = dynamic_cast<const StructureOf<Octree>*>(&structure)) {
    return std::forward<F>(f)(octree->concrete());
  }
  if (const auto* bsp = dynamic_cast<const StructureOf<Bsp>*>(&structure)) {
    return std::forward<F>(f)(bsp->concrete());
  }
  if (const auto* grid = dynamic_cast<const StructureOf<Grid>*>(&structure)) {
    return std::forward<F>(f)(grid->concrete());
  }
  if (const auto* bvh = dynamic_cast<const StructureOf<Bvh>*>(&structure)) {
    return std::forward<F>(f)(bvh->concrete());
  }
  if (const auto* instances = dynamic_cast<const StructureOf<TwoLevelBvh>*>(&structure)) {
    return std::forward<F>(f)(instances->concrete());
  }
  if (const auto* brute = dynamic_cast<const StructureOf<BruteForce>*>(&structure)) {
    return std::forward<F>(f)(brute->concrete());
  }
  if (const auto* lazy = dynamic_cast<const StructureOf<LazyOctree>*>(&structure)) {
    return std::forward<F>(f)(lazy->concrete());
  }
  throw sim::InternalError("a structure of a kind visit_structure does not know");
}

}  // namespace marti::accel
