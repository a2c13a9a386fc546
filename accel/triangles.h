// The primitives of a scene laid out for intersection: triangles of nine doubles each, then spheres,
// cylinders and cones.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/cut_outs.h"
#include "accel/quadric_shape.h"
#include "scenes/scene.h"

namespace marti::accel {

/// Corners a, b, c as ax ay az bx by bz cx cy cz. A vertex shared by triangles is copied bit for bit, which
/// makes their common edges watertight. Of a triangle without area (scenes::has_no_area) two corners are
/// equal, so that no ray hits it.
using TriangleCorners = std::array<double, 9>;

/// The largest magnitude of a coordinate: products of three must stay far from overflow.
inline constexpr double largest_coordinate = 0x1p300;

using scenes::PrimitiveRange;

/// Primitive ids are indices: of T triangles, triangle i is Scene::triangles[i] and has the id i; the curved
/// primitive i is Scene::quadrics[i] and has the id T + i.
class TriangleSet {
 public:
  TriangleSet() = default;
  /// The scene's triangles must be valid (see scene.h): indices in range. Throws UserError for invalid
  /// positions and quadrics. Those of a scene with instances are in the coordinates of their meshes.
  explicit TriangleSet(const scenes::Scene& scene);
  /// Coordinates must be finite with magnitudes up to 2^300, and quadrics valid; throws UserError otherwise.
  explicit TriangleSet(std::vector<TriangleCorners> triangles,
                       const std::vector<scenes::Quadric>& quadrics = {});

  /// Bytes of host memory that the set of a scene's primitives takes.
  [[nodiscard]] static std::uint64_t host_bytes(const scenes::Scene& scene) {
    return scene.triangles.size() * sizeof(TriangleCorners) +
           scene.instances.size() * sizeof(scenes::InstancePlace) +
           scene.quadrics.size() * sizeof(QuadricShape) + CutOuts::host_bytes(scene);
  }

  /// The number of all primitives; ids are below it.
  [[nodiscard]] std::uint32_t size() const {
    return static_cast<std::uint32_t>(triangles_.size() + quadrics_.size());
  }
  /// The number of triangles; their ids are below it.
  [[nodiscard]] std::uint32_t triangles() const { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] PrimitiveKind kind(std::uint32_t id) const {
    return id < triangles() ? PrimitiveKind::triangle : quadric(id).kind;
  }
  /// The triangle with the id `id`, which must be that of a triangle.
  [[nodiscard]] const TriangleCorners& operator[](std::uint32_t id) const { return triangles_[id]; }
  /// The sphere, cylinder or cone with the id `id`, which must be that of one.
  [[nodiscard]] const QuadricShape& quadric(std::uint32_t id) const {
    return quadrics_[id - triangles_.size()];
  }
  /// A corner of the triangle `id`.
  [[nodiscard]] glm::dvec3 corner(std::uint32_t id, unsigned which) const {
    const double* p = &triangles_[id][std::size_t{3} * which];
    return {p[0], p[1], p[2]};
  }
  /// The scene's meshes and where they stand; empty unless the scene has instances.
  [[nodiscard]] const std::vector<PrimitiveRange>& meshes() const { return meshes_; }
  [[nodiscard]] const std::vector<scenes::InstancePlace>& instances() const { return instances_; }
  /// The holes of the triangles; null where none has any.
  [[nodiscard]] const CutOuts* cut_outs() const { return cut_outs_.get(); }
  /// The Gaussians whose proxies the triangles are; null: none's.
  [[nodiscard]] const scenes::Gaussians* gaussians() const { return gaussians_.get(); }
  /// The tight box of all primitives, in all instances; empty when there are none.
  [[nodiscard]] const scenes::Bounds& bounds() const { return bounds_; }
  /// The tight box of some of them.
  [[nodiscard]] scenes::Bounds bounds(PrimitiveRange range) const;

 private:
  void check_triangles();
  void add_quadrics(const std::vector<scenes::Quadric>& quadrics);

  std::vector<TriangleCorners> triangles_;
  std::vector<QuadricShape> quadrics_;
  std::vector<PrimitiveRange> meshes_;
  std::vector<scenes::InstancePlace> instances_;
  std::shared_ptr<const CutOuts> cut_outs_;
  std::shared_ptr<const scenes::Gaussians> gaussians_;
  scenes::Bounds bounds_;
};

}  // namespace marti::accel
