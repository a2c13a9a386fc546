// How much of a cell its surfaces cover, seen from any direction: the geometry of the voxel cut.
//
// Surfaces inside a cell have areas a_i and unit normals n_i. Seen along d they cover at most sum a_i |n_i .
// d|. By Cauchy and Schwarz this is no more than sqrt(A d'Md) with A = sum a_i and M = sum a_i n_i n_i', and
// equal to it when all surfaces have the same slope to d, as nearly holds in a small cell. M does not depend
// on the side to which a normal points, and -Md is the mean of the normals turned to the viewer, weighted by
// the areas that the viewer sees.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/triangles.h"

namespace marti::accel {

/// A symmetric 3 x 3 matrix: xx, yy, zz, xy, xz, yz.
template <class T>
using SymmetricForm = std::array<T, 6>;

/// The six products of a direction's components, in the order of SymmetricForm; mixed ones doubled, so that
/// d'Md is the sum of six products.
template <class Real>
[[nodiscard]] inline SymmetricForm<Real> products_of(const std::array<Real, 3>& d) {
  const Real two(2.0);
  return {d[0] * d[0],         d[1] * d[1],         d[2] * d[2],
          two * (d[0] * d[1]), two * (d[0] * d[2]), two * (d[1] * d[2])};
}

/// The surfaces in a cell. Areas are measured as if the cell were as large as the root (times 4^(level - 1)),
/// in squares of the root's longest edge.
struct VoxelCover {
  float area = 0.0F;
  SymmetricForm<float> form{};

  /// The area covered, seen along the unit direction whose products_of() is given.
  template <class Real>
  [[nodiscard]] Real seen(const SymmetricForm<Real>& products) const {
    using std::sqrt;
    Real sum = Real(double{form[0]}) * products[0];
    for (std::size_t k = 1; k < 6; ++k) {
      sum = sum + Real(double{form[k]}) * products[k];
    }
    return sqrt(sum > Real(0.0) ? Real(double{area}) * sum : Real(0.0));
  }
};

/// The part of a triangle inside a box: at most nine corners, in the triangle's winding; empty when it is
/// outside. `points` is overwritten (Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974).
void clip_to_box(const TriangleCorners& triangle, const glm::dvec3& lo, const glm::dvec3& hi,
                 std::vector<glm::dvec3>& points);

}  // namespace marti::accel
