// Gaussians as trainers of 3D Gaussian splatting leave them (Kerbl, Kopanas, Leimkühler, Drettakis, "3D
// Gaussian Splatting for Real-Time Radiance Field Rendering", TOG 42(4), 2023), and the triangles by which
// rays find them.
//
// As in 3D Gaussian ray tracing (Moenne-Loccoz et al., TOG 43(6), 2024, section 4.1) each stands within a
// proxy of 20 triangles, which encloses the ellipsoid in which its alpha is at least 1/255. All proxies are
// one icosahedron in other places: its instances where they are kept (the shared lower level of GRTX, Lee et
// al., HPCA 2026), else copies. Either way the primitives of Gaussian g are 20 g to 20 g + 19.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace marti::scenes {

/// Below this a Gaussian adds nothing to a ray, as in the rasterizer of 2023.
inline constexpr double least_alpha = 1.0 / 255.0;
inline constexpr std::uint32_t proxy_triangles = 20;
/// Its proxy is by so much larger than what encloses the ellipsoid: rays that must find it do not graze it.
inline constexpr double proxy_inradius = 1.0 + 0x1p-6;
inline constexpr unsigned largest_degree = 3;

/// Where a Gaussian is. `inverse` times the distance from the centre is y: at |y| = 1 its alpha is 1/255,
/// elsewhere opacity * 2^(-|y|^2 * falloff).
struct Gaussian {
  glm::dvec3 center{0.0};
  glm::dmat3 inverse{1.0};
  double opacity = 1.0;  ///< above 1/255, at most 1
  double falloff = 8.0;  ///< log2(255 * opacity)
};

/// All Gaussians of a scene.
struct Gaussians {
  std::vector<Gaussian> shapes;  ///< by add()
  double stretch = 1.0;          ///< how much longer than another an axis of one is, at most
  unsigned degree = 0;           ///< of their spherical harmonics, up to largest_degree
  /// Of each Gaussian those of red, then of green, then of blue, terms() each.
  std::vector<float> coefficients;

  void add(const Gaussian& gaussian);
  [[nodiscard]] unsigned terms() const { return (degree + 1) * (degree + 1); }
  /// Records of 64 bytes that each takes in a database of 4-byte words: the first has its inverse, centre,
  /// opacity and three coefficients of degree 0; those of higher degree have 16 coefficients each.
  [[nodiscard]] std::uint32_t records() const { return degree + 1; }
  [[nodiscard]] std::span<const float> of(std::uint32_t gaussian, unsigned channel) const {
    return {&coefficients[(std::size_t{gaussian} * 3 + channel) * terms()], terms()};
  }
};

/// The normals of ten faces of an icosahedron, times the root of 3; those of the others point the other way.
extern const std::array<glm::dvec3, proxy_triangles / 2> proxy_normals;

}  // namespace marti::scenes
