// gaussians(n): the pot of teapot(n), a flat Gaussian in the place of each triangle, with light and gloss
// baked into its harmonics as a trainer would find them. Not one of the Standard Procedural Databases.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scenes/gaussian_proxies.h"
#include "scenes/harmonics.h"
#include "scenes/spd.h"
#include "sim/mix.h"

namespace marti::scenes::spd {

namespace {

/// The share of light of each degree that a gloss keeps about the direction in which it is reflected.
constexpr std::array<double, largest_degree + 1> gloss = {0.10, 0.22, 0.24, 0.18};

void add_colors(const glm::dvec3& normal, Gaussians& all) {
  const glm::dvec3 light = glm::normalize(glm::dvec3(0.4, 0.7, 0.6));
  const double lit = 0.25 + 0.75 * std::max(glm::dot(normal, light), 0.0);
  const glm::dvec3 base = glm::dvec3(0.95, 0.60, 0.20) * lit;
  // A ray that sees the light's mirror image goes the way of the light back.
  const glm::dvec3 seen = light - 2.0 * glm::dot(light, normal) * normal;
  std::array<double, most_harmonics> harmonics{};
  harmonics_at(seen, largest_degree, harmonics);
  for (int channel = 0; channel < 3; ++channel) {
    for (unsigned term = 0, degree = 0; term < all.terms(); ++term) {
      degree += term == (degree + 1) * (degree + 1) ? 1U : 0U;
      const double shine = gloss[degree] * lit * harmonics[term];
      const double color = term == 0 ? (base[channel] - 0.5) / harmonics[0] : 0.0;
      all.coefficients.push_back(static_cast<float>(color + shine));
    }
  }
}

}  // namespace

Scene make_gaussians(std::uint32_t n) {
  Scene pot = make_teapot(n, false);
  Scene scene;
  scene.camera = pot.camera;
  scene.background = pot.background;
  scene.lights = pot.lights;
  scene.ambient = pot.ambient;
  Gaussians all;
  all.degree = largest_degree;
  all.shapes.reserve(pot.triangles.size());
  all.coefficients.reserve(pot.triangles.size() * 3 * all.terms());
  for (std::size_t i = 0; i < pot.triangles.size(); ++i) {
    const auto corner = [&](std::size_t k) { return pot.positions[pot.triangles[i].vertex.at(k)]; };
    const glm::dvec3 a = corner(1) - corner(0);
    const glm::dvec3 b = corner(2) - corner(0);
    const glm::dvec3 x = glm::normalize(a);
    const glm::dvec3 z = glm::normalize(glm::cross(a, b));
    const glm::dvec3 y = glm::cross(z, x);
    Splat splat;
    splat.center = corner(0) + (a + b) / 3.0;
    splat.rotation = glm::quat_cast(glm::dmat3(x, y, z));
    splat.deviation = {0.4 * glm::length(a), 0.4 * glm::dot(b, y), 0.0};
    splat.deviation.z = 0.1 * std::min(splat.deviation.x, splat.deviation.y);
    splat.opacity = 0.4 + 0.55 * static_cast<double>(sim::mix(i) >> 32U) * 0x1p-32;
    all.add(gaussian_of(splat).value());
    add_colors(z, all);
  }
  scene.gaussians = std::make_shared<const Gaussians>(std::move(all));
  return scene;
}

}  // namespace marti::scenes::spd
