// Internal to scenes/: the recipes behind make_procedural, and their common functions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/scene.h"

namespace marti::scenes::spd {

/// The NFF highlight exponent of a lobe with half its strength at `degrees` from the mirror direction: ln 0.5
/// / ln cos(angle); 100,000 for 0 degrees.
[[nodiscard]] double shininess_of_angle(double degrees);

/// Adds L point lights of intensity sqrt(L) / (2 L) each, and ambient light of the same intensity.
void set_lights(Scene& scene, std::span<const glm::dvec3> positions);

/// A scene with the given camera, the SPD's field of view of 45 degrees and its sky-blue background.
[[nodiscard]] Scene make_scene(const glm::dvec3& eye, const glm::dvec3& at, const glm::dvec3& up);

/// Adds vertices; equal positions (with equal normals) get the same index, so that neighbouring triangles
/// share vertices bit for bit.
class VertexWelder {
 public:
  explicit VertexWelder(Scene& scene) : scene_(scene) {}
  /// A vertex without a normal of its own.
  std::uint32_t add(const glm::dvec3& position) { return add(position, glm::dvec3(0.0)); }
  /// Normals that differ by at most 1e-9 count as equal; such differences are rounding, not creases.
  std::uint32_t add(const glm::dvec3& position, const glm::dvec3& normal);

 private:
  struct Hash {
    std::size_t operator()(const glm::dvec3& p) const;
  };
  Scene& scene_;
  std::unordered_map<glm::dvec3, std::vector<std::uint32_t>, Hash> at_;
};

/// A material with the given weights of diffuse light, mirror and highlight; the highlight's width is that of
/// shininess_of_angle.
[[nodiscard]] Material make_material(std::string name, const glm::dvec3& color, double diffuse,
                                     double reflection = 0.0, double highlight = 0.0, double angle = 0.0);

/// Adds a material and returns its index.
std::uint32_t add_material(Scene& scene, Material material);

void add_sphere(Scene& scene, const glm::dvec3& center, double radius, std::uint32_t material);
void add_cylinder(Scene& scene, const glm::dvec3& base, const glm::dvec3& tip, double radius,
                  std::uint32_t material);
void add_cone(Scene& scene, const glm::dvec3& base, const glm::dvec3& tip, double radius, double tip_radius,
              std::uint32_t material);
/// Adds the quadrilateral a b c d as two triangles and one polygon.
void add_square(Scene& scene, const std::array<glm::dvec3, 4>& corners, std::uint32_t material);

/// The vector turned about the unit vector `axis`, right-handed (Rodrigues' formula).
[[nodiscard]] glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& axis, double radians);

[[nodiscard]] Scene make_balls(std::uint32_t n);
/// Without proxies (gaussian_proxies.h).
[[nodiscard]] Scene make_gaussians(std::uint32_t n);
[[nodiscard]] Scene make_gears(std::uint32_t n);
[[nodiscard]] Scene make_jacks(std::uint32_t n);
[[nodiscard]] Scene make_large();
[[nodiscard]] Scene make_lattice(std::uint32_t n);
[[nodiscard]] Scene make_mount(std::uint32_t n);
[[nodiscard]] Scene make_rings(std::uint32_t n);
[[nodiscard]] Scene make_room(std::uint32_t n);
[[nodiscard]] Scene make_shells(std::uint32_t n);
[[nodiscard]] Scene make_sombrero(std::uint32_t n);
[[nodiscard]] Scene make_teapot(std::uint32_t n, bool with_board);
[[nodiscard]] Scene make_tetra(std::uint32_t n);
[[nodiscard]] Scene make_tree(std::uint32_t n);

}  // namespace marti::scenes::spd
