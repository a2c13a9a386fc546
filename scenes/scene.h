// The scene database: the result of every loader and generator, and the input of everything else. World
// space, right-handed, lengths in the scene's own unit, colours linear RGB. A Scene from a loader is valid:
// positions are finite, indices in range, materials exist.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scenes/camera.h"
#include "scenes/gaussians.h"
#include "scenes/given_rays.h"
#include "scenes/instance.h"
#include "scenes/quadric.h"

namespace marti::scenes {

inline constexpr std::uint32_t no_texture = 0xffffffffU;

/// One triangle of the intersection database. Its index in Scene::triangles is its primitive id.
struct Triangle {
  std::array<std::uint32_t, 3> vertex{};  ///< indices into Scene::positions (and normals, uvs)
  std::uint32_t material = 0;             ///< index into Scene::materials
  std::uint32_t polygon = 0;              ///< number of the source polygon it was cut from, from 0
};

/// Whitted's material with the weights of the Standard Procedural Databases.
/// Shaded colour = emission + ambient + sum over visible lights (color * diffuse * n.l + highlight *
/// (n.h)^shininess) * light + reflection * reflected ray + transmission * refracted ray.
// What a file may ask for; shading stays finite with it.
inline constexpr double largest_emission = 1e9;
inline constexpr double largest_ior = 100.0;

/// The cut-off of materials whose files ask for blending with what lies behind them.
inline constexpr double cutoff_of_blending = 0.5;

/// Where a material is cut out: a ray goes on through a point whose alpha, this one times the texel's, is
/// below the cut-off. It is either cut out at such a point or opaque; nothing is blended.
struct CutOut {
  double alpha = 1.0;   ///< 0 to 1
  double cutoff = 0.0;  ///< 0: nowhere
  std::uint32_t texture = no_texture;

  /// Whether no hit counts: no texel has an alpha above 1. Readers leave such triangles out.
  [[nodiscard]] bool everywhere() const { return alpha < cutoff; }
  /// Whether a hit has to be asked about.
  [[nodiscard]] bool asks() const { return cutoff > 0.0 && texture != no_texture; }
  /// Of a point at which the texture has this alpha.
  [[nodiscard]] bool keeps(double of_texel) const { return alpha * of_texel >= cutoff; }
};

struct Material {
  std::string name;
  glm::dvec3 color{0.8};           ///< linear, 0 to 1; multiplied by the texture if there is one
  glm::dvec3 specular_color{1.0};  ///< tint of highlight and reflection (white for dielectrics)
  glm::dvec3 emission{0.0};
  double diffuse = 1.0;       ///< Kd, 0 to 1
  double reflection = 0.0;    ///< weight of the reflected ray, 0 to 1
  double transmission = 0.0;  ///< weight of the refracted ray, 0 to 1
  double ior = 1.0;           ///< index of refraction, at least 1
  double highlight = 0.0;     ///< weight of the lights' highlights, 0 to 1
  double shininess = 1.0;     ///< exponent of the highlight
  std::uint32_t texture = no_texture;
  CutOut cut_out;
};

/// Decoded 8-bit RGBA texels, rows from the top; `srgb` says whether sampling converts them to linear values.
struct Texture {
  std::string name;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool srgb = true;
  bool repeat_u = true;
  bool repeat_v = true;
  bool grey_is_alpha = false;  ///< the alpha is the mean of a texel's colours, and not its fourth sample
  /// width * height texels, or none if they are not decoded: every sample is then white, and `file` may hold
  /// the encoded image.
  std::vector<std::array<std::uint8_t, 4>> texels;
  std::shared_ptr<const std::vector<std::byte>> file;

  [[nodiscard]] std::uint64_t size() const { return std::uint64_t{width} * height; }
};

enum class LightKind : std::uint8_t { point, directional, spot };

struct Light {
  LightKind kind = LightKind::point;
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< in which the light shines, unit length (directional, spot)
  glm::dvec3 color{1.0};                 ///< colour times intensity
  bool inverse_square = false;           ///< glTF's punctual lights fall off; those of the SPD do not
  double range = 0.0;                    ///< 0: unlimited
  double cos_inner_cone = 1.0;
  double cos_outer_cone = 0.70710678118654752;
};

/// Everything that a frame needs. `normals` and `uvs` are empty or as long as `positions`; a zero normal
/// means that the triangle's own is used.
struct Scene {
  std::string name;
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;
  std::vector<glm::dvec2> uvs;
  std::vector<Triangle> triangles;
  /// Without instances all of the scene is as described here. With them, each triangle is of exactly one of
  /// `meshes`, whose vertices are in coordinates of its own, and the scene is what the instances make of
  /// them; there are no quadrics then, and emissive triangles only in the mesh of the first instance, which
  /// begins with triangle 0 and is where it is. Primitive ids are those of a scene in which each instance is
  /// copied, one after the other.
  std::vector<PrimitiveRange> meshes;
  std::vector<InstancePlace> instances;
  std::vector<Quadric> quadrics;  ///< primitive ids from triangles.size() on; each valid as in quadric.h
  /// The Gaussians that the triangles are proxies of (gaussians.h), of all triangles and instances; null: of
  /// none.
  std::shared_ptr<const Gaussians> gaussians;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;
  bool lights_are_all =
      false;  ///< none is missing, even if there is none: a recipe's, and a file's that says so
  Camera camera;
  bool framed = false;  ///< the file has no camera; this one sees all of the scene
  GivenRays rays;       ///< traced in the place of the camera's; without any, the camera's are
  glm::dvec3 background{0.0};
  glm::dvec3 ambient{0.0};         ///< ambient light, multiplied by a material's colour and diffuse weight
  std::uint64_t polygons = 0;      ///< polygons of the source, before triangulation
  std::vector<std::string> notes;  ///< what the loader chose or left out, one sentence each
};

/// Whether three corners lie on a line, or so close together (2^-340) that products of three of their
/// distances are below the smallest normal double. No ray hits such a triangle.
[[nodiscard]] bool has_no_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// What a primitive id stands for.
struct HitTriangle {
  std::uint32_t triangle = 0;            ///< index into Scene::triangles; beyond them: the id of a quadric
  const InstancePlace* place = nullptr;  ///< null: the triangle is where its vertices are

  HitTriangle(std::uint32_t id, const InstancePlace* of = nullptr) : triangle(id), place(of) {}
};
[[nodiscard]] HitTriangle hit_triangle(const Scene& scene, std::uint32_t primitive);

/// Numbers the primitives of all instances (InstancePlace::first) and bounds their rounding. Throws UserError
/// when there are 2^32 - 1 or more, or when one is farther than 2^300 from the origin.
void number_instances(Scene& scene);

/// The scene in which each instance is copied.
[[nodiscard]] Scene copied_instances(const Scene& scene);

/// The material of a triangle, or of a quadric by its primitive id.
[[nodiscard]] inline std::uint32_t material_of(const Scene& scene, std::uint32_t primitive) {
  return primitive < scene.triangles.size() ? scene.triangles[primitive].material
                                            : scene.quadrics[primitive - scene.triangles.size()].material;
}

/// Axis-aligned bounds. Empty (lo > hi) until the first point.
struct Bounds {
  glm::dvec3 lo;
  glm::dvec3 hi;
  Bounds();
  void include(const glm::dvec3& point);
  [[nodiscard]] bool empty() const { return lo.x > hi.x; }
};

/// The tight box of a valid quadric, up to rounding.
[[nodiscard]] Bounds bounds_of(const Quadric& quadric);

/// The bounds of the scene: of its triangles' vertices, in all instances (unreferenced vertices do not
/// count), and of the quadrics.
[[nodiscard]] Bounds bounds_of(const Scene& scene);

}  // namespace marti::scenes
