#include "scenes/placement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "scenes/merged_instances.h"
#include "scenes/vertex_values.h"
#include "sim/error.h"
#include "sim/key_error.h"

namespace marti::scenes {

namespace {

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// The vector at length 1, or 0 if it is 0. Divided first, so that no square leaves the doubles.
glm::dvec3 direction_of(const glm::dvec3& v) {
  const double size = largest(v);
  return size > 0.0 ? glm::normalize(v / size) : v;
}

std::pair<double, double> cosine_and_sine(double degrees) {
  const double turns = std::fmod(degrees, 360.0) / 90.0;
  if (turns == std::trunc(turns)) {
    constexpr double cosines[4] = {1.0, 0.0, -1.0, 0.0};
    const auto quarter = static_cast<std::size_t>((static_cast<int>(turns) + 4) % 4);
    return {cosines[quarter], cosines[(quarter + 3) % 4]};
  }
  const double angle = degrees * std::numbers::pi / 180.0;
  return {std::cos(angle), std::sin(angle)};
}

class Placing {
 public:
  Placing(const Placement& placement, const std::string& name, Scene& scene)
      : placement_(placement), name_(name), scene_(scene), fixed_(fixed_triangles(scene)) {}

  void all() {
    const glm::dmat3 of_normals = glm::transpose(glm::inverse(placement_.linear));
    const bool mirrors = glm::determinant(placement_.linear) < 0.0;
    const std::vector<bool> stay = vertices_of_instances();
    for (std::size_t v = 0; v < scene_.positions.size(); ++v) {
      if (stay.empty() || !stay[v]) {
        scene_.positions[v] = moved(scene_.positions[v]);
        if (!scene_.normals.empty()) {
          scene_.normals[v] = direction_of(of_normals * scene_.normals[v]);
        }
      }
    }
    for (std::uint32_t t = 0; t < fixed_ && mirrors; ++t) {
      std::swap(scene_.triangles[t].vertex[1], scene_.triangles[t].vertex[2]);
    }
    instances();
    quadrics();
    for (Light& light : scene_.lights) {
      light.position = moved(light.position);
      light.direction = direction_of(placement_.linear * light.direction);
      light.range *= std::cbrt(std::abs(glm::determinant(placement_.linear)));
    }
    if (!scene_.framed) {
      camera();
    }
  }

 private:
  [[nodiscard]] glm::dvec3 moved(const glm::dvec3& point) const {
    const glm::dvec3 place = placement_.linear * point + placement_.offset;
    if (!(largest(place) <= largest_coordinate)) {
      throw sim::UserError(name_ + ": its transform moves a point beyond 1e30");
    }
    return place;
  }

  /// Whether a vertex is of a mesh that instances move; empty without instances.
  [[nodiscard]] std::vector<bool> vertices_of_instances() const {
    std::vector<bool> of_instances(scene_.instances.empty() ? 0 : scene_.positions.size());
    for (std::size_t t = fixed_; t < scene_.triangles.size(); ++t) {
      for (const std::uint32_t vertex : scene_.triangles[t].vertex) {
        of_instances[vertex] = true;
      }
    }
    return of_instances;
  }

  void instances() {
    for (std::size_t i = fixed_ > 0 ? 1 : 0; i < scene_.instances.size(); ++i) {
      InstancePlace& place = scene_.instances[i];
      place.linear = placement_.linear * place.linear;
      place.shift = moved(place.shift);
      if (const std::string why = why_not_kept(place); !why.empty()) {
        throw sim::KeyError(
            "structure.instances",
            name_ + ": after its transform, an instance cannot be kept: " + why + "; set \"copied\"");
      }
    }
    if (!scene_.instances.empty()) {
      number_instances(scene_);
    }
  }

  void quadrics() {
    if (scene_.quadrics.empty()) {
      return;
    }
    const double scale = common_scale(placement_.linear);
    if (scale == 0.0) {
      throw sim::UserError(name_ +
                           ": its spheres, cylinders and cones can be moved, turned, mirrored and scaled, "
                           "but alike in all directions");
    }
    for (Quadric& quadric : scene_.quadrics) {
      quadric.base = moved(quadric.base);
      quadric.tip = moved(quadric.tip);
      quadric.radius *= scale;
      quadric.tip_radius *= scale;
      check_quadric(quadric,
                    name_ + ": after its transform, curved primitive " + std::to_string(quadric.source));
    }
  }

  void camera() {
    Camera& camera = scene_.camera;
    camera.eye = moved(camera.eye);
    camera.at = moved(camera.at);
    camera.up = direction_of(placement_.linear * camera.up);
    try {
      static_cast<void>(camera.image_plane(1, 1));
    } catch (const sim::UserError& error) {
      throw sim::UserError(name_ + ": after its transform, " + error.what());
    }
  }

  const Placement& placement_;
  const std::string& name_;
  Scene& scene_;
  const std::uint32_t fixed_;  // triangles
};

}  // namespace

bool is_singular(const glm::dmat3& linear) {
  glm::dmat3 unit;
  for (int i = 0; i < 3; ++i) {
    unit[i] = direction_of(linear[i]);
  }
  constexpr double flat = 1e-10;
  return !(std::abs(glm::determinant(unit)) > flat);
}

double common_scale(const glm::dmat3& linear) {
  const double scale = glm::length(linear[0]);
  constexpr double rounding = 1e-12;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double expected = i == j ? 1.0 : 0.0;
      if (std::abs(glm::dot(linear[i] / scale, linear[j] / scale) - expected) > rounding) {
        return 0.0;
      }
    }
  }
  return scale;
}

glm::dmat3 rotation_by(const glm::dvec3& degrees) {
  const auto [cx, sx] = cosine_and_sine(degrees.x);
  const auto [cy, sy] = cosine_and_sine(degrees.y);
  const auto [cz, sz] = cosine_and_sine(degrees.z);
  const glm::dmat3 x({1.0, 0.0, 0.0}, {0.0, cx, sx}, {0.0, -sx, cx});
  const glm::dmat3 y({cy, 0.0, -sy}, {0.0, 1.0, 0.0}, {sy, 0.0, cy});
  const glm::dmat3 z({cz, sz, 0.0}, {-sz, cz, 0.0}, {0.0, 0.0, 1.0});
  return z * y * x;
}

void place(const Placement& placement, const std::string& name, Scene& scene) {
  Placing(placement, name, scene).all();
}

}  // namespace marti::scenes
