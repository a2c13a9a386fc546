#include "scenes/tessellate.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <glm/geometric.hpp>

#include "sim/error.h"

namespace marti::scenes {

namespace {

constexpr std::uint32_t sides = tessellation_sides;

/// An axis and two directions across it; right-handed.
struct Frame {
  glm::dvec3 right;
  glm::dvec3 up;
  glm::dvec3 axis;

  explicit Frame(const glm::dvec3& along) : axis(along) {
    const glm::dvec3 aside = std::abs(axis.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    right = glm::normalize(glm::cross(aside, axis));
    up = glm::cross(axis, right);
  }
  /// The unit vector across the axis at step `i` of a full turn.
  [[nodiscard]] glm::dvec3 around(std::uint32_t i) const {
    const double angle = 2.0 * std::numbers::pi * (i % sides) / sides;
    return std::cos(angle) * right + std::sin(angle) * up;
  }
};

class Tessellator {
 public:
  explicit Tessellator(Scene& scene) : scene_(scene) {
    if (scene_.normals.empty()) {
      // A zero normal means the triangle's own.
      scene_.normals.resize(scene_.positions.size(), glm::dvec3(0.0));
    }
  }

  void add(const Quadric& quadric) {
    if (scene_.positions.size() > std::numeric_limits<std::uint32_t>::max() - 1024U) {
      throw sim::UserError("a scene of so many spheres, cylinders and cones cannot be cut into triangles");
    }
    quadric_ = &quadric;
    if (quadric.kind == QuadricKind::sphere) {
      add_sphere();
    } else {
      add_cone();
    }
    ++scene_.polygons;
  }

 private:
  std::uint32_t vertex(const glm::dvec3& position, const glm::dvec3& normal) {
    scene_.positions.push_back(position);
    scene_.normals.push_back(normal);
    if (!scene_.uvs.empty()) {
      scene_.uvs.emplace_back(0.0);
    }
    return static_cast<std::uint32_t>(scene_.positions.size() - 1);
  }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    scene_.triangles.push_back({{a, b, c}, quadric_->material, static_cast<std::uint32_t>(scene_.polygons)});
  }

  /// Adds triangles between two rings of corners, the upper one farther along the axis; a ring whose corners
  /// all lie at one point is a tip.
  void join(const std::array<std::uint32_t, sides>& lower, const std::array<std::uint32_t, sides>& upper,
            bool lower_is_tip, bool upper_is_tip) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t j = (i + 1) % sides;
      if (!lower_is_tip) {
        triangle(lower[i], lower[j], upper[j]);
      }
      if (!upper_is_tip) {
        triangle(lower[i], upper[j], upper[i]);
      }
    }
  }

  void add_sphere() {
    const Frame frame(glm::dvec3(0.0, 0.0, 1.0));
    constexpr std::uint32_t rings = sides / 2;  // from pole to pole
    std::array<std::uint32_t, sides> below{};
    for (std::uint32_t k = 0; k <= rings; ++k) {
      const bool pole = k == 0 || k == rings;
      const double height = pole ? (k == 0 ? -1.0 : 1.0) : -std::cos(std::numbers::pi * k / rings);
      const double width = pole ? 0.0 : std::sin(std::numbers::pi * k / rings);
      std::array<std::uint32_t, sides> ring{};
      for (std::uint32_t i = 0; i < sides; ++i) {
        const glm::dvec3 normal = width * frame.around(i) + height * frame.axis;
        ring[i] = pole && i > 0 ? ring[0] : vertex(quadric_->base + quadric_->radius * normal, normal);
      }
      if (k > 0) {
        join(below, ring, k == 1, k == rings);
      }
      below = ring;
    }
  }

  void add_cone() {
    const glm::dvec3 along = quadric_->tip - quadric_->base;
    const double height = std::hypot(along.x, along.y, along.z);
    const Frame frame(along / height);
    const double slope = (quadric_->end_radius() - quadric_->radius) / height;
    const auto ring_at = [&](const glm::dvec3& center, double radius) {
      std::array<std::uint32_t, sides> ring{};
      // A tip too has a corner for each side, with the normal of that side.
      for (std::uint32_t i = 0; i < sides; ++i) {
        const glm::dvec3 out = frame.around(i);
        ring[i] = vertex(center + radius * out, glm::normalize(out - slope * frame.axis));
      }
      return ring;
    };
    const auto lower = ring_at(quadric_->base, quadric_->radius);
    const auto upper = ring_at(quadric_->tip, quadric_->end_radius());
    join(lower, upper, quadric_->radius == 0.0, quadric_->end_radius() == 0.0);
  }

  Scene& scene_;
  const Quadric* quadric_ = nullptr;
};

}  // namespace

void tessellate(Scene& scene) {
  if (scene.quadrics.empty()) {
    return;
  }
  Tessellator tessellator(scene);
  for (std::size_t i = 0; i < scene.quadrics.size(); ++i) {
    check_quadric(scene.quadrics[i], "the sphere, cylinder or cone " + std::to_string(i));
    tessellator.add(scene.quadrics[i]);
  }
  scene.notes.push_back(std::to_string(scene.quadrics.size()) +
                        " spheres, cylinders and cones became triangles, within 1.8 % of their radius");
  scene.quadrics.clear();
}

}  // namespace marti::scenes
