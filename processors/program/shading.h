// The illumination of one surface point: normals, secondary ray origins, lights, reflection, refraction.
// Templates over the scalar, so that the same code that renders is counted for the cost model.
//
// Colours follow Whitted, "An improved illumination model for shaded display", CACM 23(6), 1980, with the
// weights of scenes::Material.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "accel/real.h"
#include "processors/program/power.h"
#include "processors/program/vector.h"
#include "scenes/scene.h"
#include "scenes/texture.h"

namespace marti::processors::program {

/// A hit point made ready for shading.
template <typename Real>
struct Surface {
  Vec3<Real> point;
  Vec3<Real> error;      ///< bound of each coordinate's error
  Real margin{0.0};      ///< distance from the surface within which the kernel may still report a hit
  Vec3<Real> geometric;  ///< the surface's own unit normal, on the viewer's side
  Vec3<Real> normal;     ///< the unit shading normal, on the viewer's side and facing the viewer
  Vec3<Real> color;      ///< the material's colour times the texture's
  bool outside = true;   ///< the viewer is on the side from which the triangle winds counter-clockwise,
                         ///< or outside of the sphere, cylinder or cone
  /// Square of a bound of the angle by which rounding, of the corners too, may have tilted the geometric
  /// normal.
  Held<Real> tilt_squared = 0;
  /// Where the point is so near an edge of its triangle that rounding hides on which side of the neighbour it
  /// lies, the way from there into the triangle; else zero.
  Vec3<Held<Real>> inward;
};

/// The largest relative error of one rounding: 2^-53, for floats 2^-24.
template <typename Real>
inline constexpr double rounding = accel::RealFormat<Real>::spacing * 0.5;

/// Bound of the relative error of n roundings: n eps / (1 - n eps), Higham, "Accuracy and Stability of
/// Numerical Algorithms", 2nd ed., lemma 3.1.
template <typename Real>
constexpr double gamma_bound(int n) {
  const double ne = n * rounding<Real>;
  return ne / (1.0 - ne);
}

/// Whether the program considers the lights at points of a material.
inline bool asks_lights(const scenes::Material& material) {
  return material.diffuse > 0.0 || material.highlight > 0.0;
}

inline bool is_black(const glm::dvec3& color) { return color.x == 0.0 && color.y == 0.0 && color.z == 0.0; }

/// Whether points of a material scatter light.
inline bool scatters(const scenes::Material& material) {
  return material.diffuse > 0.0 && !is_black(material.color);
}

/// Whether a light can add anything at a point of the material. On a black material none can, because lit()
/// is then a product with zero. A machine would keep this as a bit of the material's record.
inline bool shows_light(const scenes::Material& material) {
  return scatters(material) || (material.highlight > 0.0 && !is_black(material.specular_color));
}

/// Distance from the triangle with corners p within which the kernel may still report a hit of a point on it.
/// The kernel's t has an error of some 8 roundings of the triangle's own extent, however small the
/// coordinates are: a triangle in the plane z = 0 has no error in z, yet an oblique ray that starts exactly
/// there would hit it by rounding. 2^-48 (of doubles) leaves a factor of two.
template <typename Real>
Real kernel_margin(const Vec3<Real> (&p)[3]) {
  return largest(absolute(p[1] - p[0]) + absolute(p[2] - p[0])) * Real(32.0 * rounding<Real>);
}

/// How far from the edges of its triangle a ray begins, at a point whose coordinates are off by `error`, on a
/// triangle with this kernel_margin in a scene whose box has the largest side `reach`: 16 times the errors of
/// the point and of the kernel (2^-48 of the size of the scene, whose larger triangles may be the
/// neighbours).
template <typename Real>
Held<Real> edge_clearance(Held<Real> error, Held<Real> margin, double reach) {
  using Number = Held<Real>;
  return Number(16) * (Number(2) * error + margin +
                       static_cast<Number>(32.0 * rounding<Real>) * static_cast<Number>(reach));
}

/// Number of edge_clearances that a triangle must be high, so that a ray that begins anywhere on it can keep
/// off all three edges: the weights are raised to a quarter at most.
inline constexpr int sure_clearances = 4;

/// The least height of a triangle with corners p, in a scene whose box has the largest side `reach`, from
/// which on no ray that begins on it leaves a closed convex body whose triangles are all as high and meet at
/// more than some 8 degrees, nor is a light in the body hidden from it. On lower triangles rounding decides
/// on which side of the neighbour a ray begins.
///
/// Why: weights that are raised to a quarter at most add up to 1.5 at most, so the ray begins two thirds of
/// edge_clearance from every edge or more. Over the plane of a neighbour it is then higher by sin 8 degrees
/// of that, 1.48 times the sum in edge_clearance: more than the distance by which the point may be off, the
/// root of three times the error of a coordinate, and the kernel's error together.
template <typename Real>
double sure_height(const Vec3<Real> (&p)[3], double reach) {
  const Held<Real> size =
      std::max({largest(held(absolute(p[0]))), largest(held(absolute(p[1]))), largest(held(absolute(p[2])))});
  const auto error = size * static_cast<Held<Real>>(gamma_bound<Real>(7));
  return sure_clearances *
         static_cast<double>(edge_clearance<Real>(error, static_cast<Held<Real>>(kernel_margin(p)), reach));
}

/// Fills in what rounding may do to a point of a triangle with corners p and weights b: tilt_squared and
/// inward.
///
/// Two triangles that meet at an edge bound a convex body from inside. A ray that begins at the edge is moved
/// along one triangle's normal, which keeps it off that triangle, but it may begin behind the other one,
/// whose plane is as near as the error of the point: it would leave the body, or be hidden from a light
/// inside. So the ray begins an edge_clearance from every edge of its triangle, in the triangle's plane. Then
/// it is on the inner side of neighbours that meet the triangle at more than some 8 degrees.
///
/// The arithmetic is not counted among the program's operations: it matters to one ray in thousands.
template <typename Real>
void bound_rounding(Surface<Real>& surface, const Vec3<Real> (&p)[3], const Real (&b)[3], double reach) {
  using Number = Held<Real>;
  using Vec = Vec3<Number>;
  const Vec corners[3] = {held(p[0]), held(p[1]), held(p[2])};
  const Vec first = corners[1] - corners[0];
  const Vec second = corners[2] - corners[0];
  const Vec third = second - first;
  const Vec across = cross(first, second);
  const Number area_squared = dot(across, across);
  const Number longest_squared = largest(Vec(dot(first, first), dot(second, second), dot(third, third)));
  if (!in_range(area_squared) || !in_range(longest_squared)) [[unlikely]] {
    return;  // sizes whose squares leave the format: nothing is known
  }
  // The least height of the triangle is the square root of area_squared / longest_squared. Each corner is off
  // by a rounding, of which the height makes an angle; the edges and their product add a few of the longest
  // edge.
  const Vec sizes = absolute(corners[0]) + absolute(corners[1]) + absolute(corners[2]);
  constexpr auto unit = static_cast<Number>(rounding<Real>);
  const Number moved =
      Number(4) * unit * (largest(sizes) + Number(4) * largest(absolute(first) + absolute(second)));
  surface.tilt_squared = moved * moved * longest_squared / area_squared;

  const Number off =
      edge_clearance<Real>(largest(held(surface.error)), static_cast<Number>(surface.margin), reach);
  const Number weights[3] = {static_cast<Number>(b[0]), static_cast<Number>(b[1]), static_cast<Number>(b[2])};
  const Number least = std::min({weights[0], weights[1], weights[2]});
  if (least * least * area_squared >= off * off * longest_squared) [[likely]] {
    return;
  }
  // Each weight is the distance from an edge over the height on it. In triangles that are smaller than that
  // the ray begins near the middle.
  const Number floor =
      std::min(Number(1) / Number(sure_clearances), off * std::sqrt(longest_squared / area_squared));
  const Number raised[3] = {std::max(weights[0], floor), std::max(weights[1], floor),
                            std::max(weights[2], floor)};
  const Number sum = raised[0] + raised[1] + raised[2];
  surface.inward = first * (raised[1] / sum - weights[1]) + second * (raised[2] / sum - weights[2]);
}

/// The point with barycentric weights b and the normals of the triangle there, seen along `direction`. Of an
/// instance the triangle is turned into its place first, as the copy would be.
/// `reach`: the largest side of the scene's box, whose rounding keeps rays that leave off the edges
/// (bound_rounding).
template <typename Real>
Surface<Real> surface_at(const scenes::Scene& scene, const scenes::HitTriangle& hit, const Real (&weights)[3],
                         const Vec3<Real>& direction, double reach) {
  scenes::Triangle t = scene.triangles[hit.triangle];
  Real b[3] = {weights[0], weights[1], weights[2]};
  if (hit.place != nullptr && hit.place->mirrors()) {
    std::swap(t.vertex[1], t.vertex[2]);
    std::swap(b[1], b[2]);
  }
  glm::dvec3 corners[3] = {scene.positions[t.vertex[0]], scene.positions[t.vertex[1]],
                           scene.positions[t.vertex[2]]};
  if (hit.place != nullptr) [[unlikely]] {
    for (glm::dvec3& corner : corners) {
      corner = hit.place->of(corner);
    }
  }
  const Vec3<Real> p0(corners[0]);
  const Vec3<Real> p1(corners[1]);
  const Vec3<Real> p2(corners[2]);

  Surface<Real> surface;
  const Vec3<Real> t0 = p0 * b[0];
  const Vec3<Real> t1 = p1 * b[1];
  const Vec3<Real> t2 = p2 * b[2];
  surface.point = t0 + t1 + t2;
  // Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 6.8.5.
  surface.error = (absolute(t0) + absolute(t1) + absolute(t2)) * Real(gamma_bound<Real>(7));
  surface.margin = kernel_margin<Real>({p0, p1, p2});
  if (hit.place != nullptr) {
    surface.margin = surface.margin + Real(hit.place->rounding * (rounding<Real> / rounding<double>));
  }

  // In floats a triangle may have lost its area, and yet be hit: then it faces the viewer.
  surface.geometric = unit_normal(p1 - p0, p2 - p0, -direction);
  surface.outside = dot(surface.geometric, direction) < Real(0.0);
  if (!surface.outside) {
    surface.geometric = -surface.geometric;
  }
  surface.normal = surface.geometric;
  bound_rounding(surface, {p0, p1, p2}, b, reach);
  if (!scene.normals.empty()) {
    glm::dvec3 normals[3] = {scene.normals[t.vertex[0]], scene.normals[t.vertex[1]],
                             scene.normals[t.vertex[2]]};
    if (hit.place != nullptr) [[unlikely]] {
      for (glm::dvec3& normal : normals) {
        normal = hit.place->normal_of(normal);
      }
    }
    const auto corner = [&](int k) {
      const glm::dvec3& n = normals[k];
      const bool none = n.x == 0.0 && n.y == 0.0 && n.z == 0.0;
      const Vec3<Real> own(n);
      // Vertex normals may point to either side: each is brought to the viewer's before they are mixed.
      return none ? surface.geometric : (dot(own, surface.geometric) < Real(0.0) ? -own : own);
    };
    const Vec3<Real> mixed = corner(0) * b[0] + corner(1) * b[1] + corner(2) * b[2];
    // Near a silhouette the mixed normal may face away although the triangle does not; then the triangle's
    // own is used. A mixed normal of length zero fails the comparison too.
    if (dot(mixed, direction) < Real(0.0)) {
      surface.normal = normalized(mixed);
    }
  }
  return surface;
}

/// Texture coordinates at the point with barycentric weights b. The scene must have uvs.
template <typename Real>
glm::dvec2 uv_at(const scenes::Scene& scene, std::uint32_t triangle, const Real (&b)[3]) {
  const scenes::Triangle& t = scene.triangles[triangle];
  return scenes::mixed_uv({scene.uvs[t.vertex[0]], scene.uvs[t.vertex[1]], scene.uvs[t.vertex[2]]}, b);
}

/// The neighbouring number in the direction of the sign of `toward`: the next greater one when toward > 0,
/// the next smaller one when toward < 0. Format: double or float.
template <typename Format>
Format next_toward(Format value, Format toward) {
  using Bits = std::conditional_t<std::is_same_v<Format, float>, std::uint32_t, std::uint64_t>;
  if (toward == Format(0) || !std::isfinite(value)) {
    return value;
  }
  if (value == Format(0)) {
    return std::copysign(std::numeric_limits<Format>::denorm_min(), toward);
  }
  const auto bits = std::bit_cast<Bits>(value);
  return std::bit_cast<Format>((value > Format(0)) == (toward > Format(0)) ? bits + 1 : bits - 1);
}

/// Where a ray that leaves the surface into `direction` begins: the point moved along the triangle's normal
/// out of its error box and the kernel's margin, each coordinate rounded outwards (Physically Based
/// Rendering, 4th ed., section 6.8.6), and at an edge into the triangle (bound_rounding). A fixed epsilon
/// fails for very small and for very large scenes.
template <typename Real>
Vec3<Real> leave(const Surface<Real>& surface, const Vec3<Real>& direction) {
  Real distance = dot(absolute(surface.geometric), surface.error) + surface.margin;
  if (dot(surface.geometric, direction) < Real(0.0)) {
    distance = -distance;
  }
  const Vec3<Real> offset = surface.geometric * distance;
  const Vec3<Real> moved = surface.point + offset;
  // The rounding outwards is integer work on a register.
  const auto outward = [](const Real& value, const Real& toward, Held<Real> inward) {
    return Real(next_toward(static_cast<Held<Real>>(value) + inward, static_cast<Held<Real>>(toward)));
  };
  return {outward(moved.x, offset.x, surface.inward.x), outward(moved.y, offset.y, surface.inward.y),
          outward(moved.z, offset.z, surface.inward.z)};
}

/// A light as one surface point sees it.
template <typename Real>
struct LightSample {
  Vec3<Real> direction;      ///< unit, from the surface to the light
  Vec3<Real> radiance;       ///< colour with all its fall-offs; zero where the light does not reach
  bool reaches = false;      ///< the radiance is not zero
  bool at_infinity = false;  ///< directional
  Held<Real> turn = 0;       ///< bound of the angle by which rounding may have turned the direction
};

/// Whether a light at this squared distance can light a point: not where it stands, or so near that its
/// radiance might not be finite; in floats also not where the square is beyond the format.
template <typename Real>
bool lights_at(const Real& squared) {
  constexpr double nearest = std::is_same_v<Real, float> ? 0x1p-100 : 0x1p-600;
  return squared > Real(nearest) && std::isfinite(static_cast<Held<Real>>(squared));
}

/// Bound of the angle by which rounding may have turned the direction from a surface to a place at this
/// squared distance, whose coordinates are off by `error` and by a rounding each. Not counted among the
/// program's operations.
template <typename Real>
Held<Real> turn_towards(const Surface<Real>& surface, const Vec3<Real>& place, const Vec3<Real>& error,
                        const Real& squared) {
  using Number = Held<Real>;
  const Number off = largest(held(surface.error)) + largest(held(error)) +
                     static_cast<Number>(4.0 * rounding<Real>) * largest(absolute(held(place)));
  return Number(2) * off / std::sqrt(static_cast<Number>(squared));
}

/// glTF's KHR_lights_punctual: spot cone, range window. inverse_square off: no inverse-square fall-off.
template <typename Real>
LightSample<Real> light_at(const scenes::Light& light, const Surface<Real>& surface) {
  using std::sqrt;
  LightSample<Real> sample;
  sample.radiance = Vec3<Real>(light.color);
  if (light.kind == scenes::LightKind::directional) {
    sample.direction = -Vec3<Real>(light.direction);
    sample.at_infinity = true;
    sample.turn = Held<Real>(8 * rounding<Real>);
    sample.reaches = largest(sample.radiance) > Real(0.0);
    return sample;
  }
  const Vec3<Real> position(light.position);
  const Vec3<Real> to_light = position - surface.point;
  const Real squared = dot(to_light, to_light);
  if (!lights_at(squared)) {
    return sample;
  }
  sample.direction = to_light * (Real(1.0) / sqrt(squared));
  sample.turn = turn_towards(surface, position, Vec3<Real>(), squared);
  Real strength(1.0);
  if (light.inverse_square) {
    strength = strength / squared;
  }
  if (light.range > 0.0) {
    const Real ratio = squared / Real(light.range * light.range);
    const Real window = Real(1.0) - ratio * ratio;
    strength = window > Real(0.0) ? strength * window : Real(0.0);
  }
  if (light.kind == scenes::LightKind::spot) {
    const Real cosine = -dot(sample.direction, Vec3<Real>(light.direction));
    const double width = light.cos_inner_cone - light.cos_outer_cone;
    Real cone = (cosine - Real(light.cos_outer_cone)) * Real(1.0 / (width > 0.001 ? width : 0.001));
    cone = cone < Real(0.0) ? Real(0.0) : (cone > Real(1.0) ? Real(1.0) : cone);
    strength = strength * (cone * cone);
  }
  sample.radiance = sample.radiance * strength;
  sample.reaches = largest(sample.radiance) > Real(0.0);
  return sample;
}

/// Whether a cosine between a surface and a direction is more than rounding makes of 0, when the angle may be
/// off by the root of `tilt_squared` and by `turn`. Not counted among the program's operations.
template <typename Number>
bool is_more_than_rounding(Number cosine, Number tilt_squared, Number turn) {
  constexpr Number clear = 0x1p-6;  // larger angles of rounding have no meaning
  return cosine > clear || cosine * cosine > Number(2) * (tilt_squared + turn * turn);
}

/// True when the light falls on the viewer's side. Both normals must face it; otherwise light would reach
/// points that the flat triangle hides from it. A light whose cosine rounding could have made of 0 lies in
/// the plane: it brings nothing, and whether a ray asks for it must not depend on where the scene's origin
/// is.
template <typename Real>
bool faces(const Surface<Real>& surface, const LightSample<Real>& light) {
  const Real shading = dot(surface.normal, light.direction);
  if (!(shading > Real(0.0))) {
    return false;
  }
  const Real flat = dot(surface.geometric, light.direction);
  return flat > Real(0.0) &&
         is_more_than_rounding(static_cast<Held<Real>>(flat), surface.tilt_squared, light.turn) &&
         is_more_than_rounding(static_cast<Held<Real>>(shading), surface.tilt_squared, light.turn);
}

/// Lambert's diffuse term, without the light's radiance.
template <typename Real>
Vec3<Real> scattered_share(const scenes::Material& material, const Surface<Real>& surface,
                           const LightSample<Real>& light) {
  return surface.color * (Real(material.diffuse) * dot(surface.normal, light.direction));
}

/// What one unoccluded light adds: Lambert's diffuse term and the highlight of the halfway vector (Blinn,
/// SIGGRAPH 1977).
template <typename Real>
Vec3<Real> lit(const scenes::Material& material, const Surface<Real>& surface, const LightSample<Real>& light,
               const Vec3<Real>& ray_direction) {
  Vec3<Real> reflected = scattered_share(material, surface, light);
  if (material.highlight > 0.0) {
    const Vec3<Real> halfway = normalized(light.direction - ray_direction);
    const Real cosine = dot(surface.normal, halfway);
    if (cosine > Real(0.0)) {
      const Real shine = power(cosine < Real(1.0) ? cosine : Real(1.0), Real(material.shininess));
      reflected = reflected + Vec3<Real>(material.specular_color) * (Real(material.highlight) * shine);
    }
  }
  return reflected * light.radiance;
}

/// The mirror direction. Where a shading normal would send it under the triangle's own plane, the
/// triangle's normal is used instead.
template <typename Real>
Vec3<Real> reflected(const Surface<Real>& surface, const Vec3<Real>& direction) {
  const auto mirror = [&](const Vec3<Real>& n) { return direction - n * (Real(2.0) * dot(n, direction)); };
  const Vec3<Real> smooth = mirror(surface.normal);
  return dot(smooth, surface.geometric) > Real(0.0) ? smooth : mirror(surface.geometric);
}

/// Snell's direction into the surface, or false at total internal reflection. `ratio` is the index of
/// refraction on the viewer's side over that beyond.
template <typename Real>
bool refracted(const Surface<Real>& surface, const Vec3<Real>& direction, const Real& ratio,
               Vec3<Real>& out) {
  using std::sqrt;
  const auto bend = [&](const Vec3<Real>& n) {
    const Real cosine = -dot(n, direction);
    const Real squared = Real(1.0) - ratio * ratio * (Real(1.0) - cosine * cosine);
    if (squared < Real(0.0)) {
      return false;
    }
    out = direction * ratio + n * (ratio * cosine - sqrt(squared));
    return true;
  };
  if (!bend(surface.normal)) {
    return false;
  }
  return dot(out, surface.geometric) < Real(0.0) || bend(surface.geometric);
}

}  // namespace marti::processors::program
