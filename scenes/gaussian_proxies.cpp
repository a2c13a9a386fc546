#include "scenes/gaussian_proxies.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "scenes/binary_power.h"
#include "scenes/merged_instances.h"
#include "scenes/scene.h"
#include "sim/error.h"
#include "sim/key_error.h"

namespace marti::scenes {

namespace {

constexpr double golden = 1.6180339887498949;

/// Corners of an icosahedron whose edges are 2 long, and its faces, counter-clockwise from outside.
constexpr std::array<std::array<double, 3>, 12> corners = {{{-1, golden, 0},
                                                            {1, golden, 0},
                                                            {-1, -golden, 0},
                                                            {1, -golden, 0},
                                                            {0, -1, golden},
                                                            {0, 1, golden},
                                                            {0, -1, -golden},
                                                            {0, 1, -golden},
                                                            {golden, 0, -1},
                                                            {golden, 0, 1},
                                                            {-golden, 0, -1},
                                                            {-golden, 0, 1}}};
constexpr std::array<std::array<std::uint32_t, 3>, proxy_triangles> faces = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

/// The proxy of a Gaussian at the origin whose `inverse` is the identity. The faces of an icosahedron with
/// edges of 2 are golden^2 / sqrt(3) from its centre.
void add_proxy(Scene& scene, const InstancePlace& place) {
  const double scale = proxy_inradius * std::sqrt(3.0) / (golden * golden);
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  for (const std::array<double, 3>& corner : corners) {
    scene.positions.push_back(place.of(scale * glm::dvec3(corner[0], corner[1], corner[2])));
  }
  for (const auto& [a, b, c] : faces) {
    scene.triangles.push_back(
        {{first + a, first + b, first + c}, 0, static_cast<std::uint32_t>(scene.polygons)});
  }
  ++scene.polygons;
}

/// The rows of the inverse are at right angles.
InstancePlace place_of(const Gaussian& gaussian) {
  const glm::dmat3 rows = glm::transpose(gaussian.inverse);
  InstancePlace place;
  place.shift = gaussian.center;
  for (int axis = 0; axis < 3; ++axis) {
    place.linear[axis] = rows[axis] / glm::dot(rows[axis], rows[axis]);
  }
  return place;
}

bool are_kept(std::uint64_t gaussians, Instances wanted) {
  return wanted == Instances::kept ||
         (wanted == Instances::automatic && gaussians * proxy_triangles > many_copies);
}

}  // namespace

const std::array<glm::dvec3, proxy_triangles / 2> proxy_normals = {{{1.0, 1.0, 1.0},
                                                                    {1.0, 1.0, -1.0},
                                                                    {1.0, -1.0, 1.0},
                                                                    {1.0, -1.0, -1.0},
                                                                    {0.0, golden, 1.0 / golden},
                                                                    {0.0, golden, -1.0 / golden},
                                                                    {1.0 / golden, 0.0, golden},
                                                                    {-1.0 / golden, 0.0, golden},
                                                                    {golden, 1.0 / golden, 0.0},
                                                                    {golden, -1.0 / golden, 0.0}}};

void Gaussians::add(const Gaussian& gaussian) {
  const glm::dmat3 rows = glm::transpose(gaussian.inverse);
  const double x = glm::length(rows[0]);
  const double y = glm::length(rows[1]);
  const double z = glm::length(rows[2]);
  stretch = std::max(stretch, std::max({x, y, z}) / std::min({x, y, z}));
  shapes.push_back(gaussian);
}

std::optional<Gaussian> gaussian_of(const Splat& splat) {
  Gaussian gaussian;
  gaussian.center = splat.center;
  gaussian.opacity = splat.opacity;
  gaussian.falloff = log_two(splat.opacity / least_alpha);
  if (!(gaussian.falloff > 0x1p-20)) {
    return std::nullopt;
  }
  // exp(-r^2 / 2) at r deviations is 2^-falloff.
  const double reach = std::sqrt(2.0 * gaussian.falloff / log_two_of_e);
  const glm::dmat3 turned = glm::mat3_cast(glm::normalize(splat.rotation));
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 0; row < 3; ++row) {
      gaussian.inverse[row][axis] = turned[axis][row] / (splat.deviation[axis] * reach);
    }
  }
  return gaussian;
}

std::uint64_t bytes_of_proxies(std::uint64_t gaussians, Instances wanted) {
  return gaussians * (are_kept(gaussians, wanted)
                          ? sizeof(InstancePlace)
                          : corners.size() * sizeof(glm::dvec3) + proxy_triangles * sizeof(Triangle));
}

void stand_proxies(Scene& scene, Instances wanted, std::uint64_t most_triangles) {
  const std::vector<Gaussian>& shapes = scene.gaussians->shapes;
  const std::uint64_t copies = shapes.size() * proxy_triangles;
  const bool kept = are_kept(shapes.size(), wanted);
  if (!kept && copies > most_triangles) {
    throw sim::KeyError("structure.instances",
                        "the proxies of " + std::to_string(shapes.size()) + " Gaussians are " +
                            std::to_string(copies) + " triangles, and at most " +
                            std::to_string(most_triangles) +
                            " are accepted; set structure.kind = \"bvh\" and structure.instances = \"kept\"");
  }
  scene.materials.emplace_back();
  scene.positions.reserve(kept ? corners.size() : corners.size() * shapes.size());
  scene.triangles.reserve(kept ? proxy_triangles : copies);
  if (kept) {
    add_proxy(scene, {});
    scene.polygons = shapes.size();
    scene.meshes.push_back({0, proxy_triangles});
    scene.instances.reserve(shapes.size());
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const InstancePlace place = place_of(shapes[i]);
    if (const std::string why = why_not_kept(place); !why.empty()) {
      throw sim::UserError("Gaussian " + std::to_string(i) + ": " + why);
    }
    if (kept) {
      scene.instances.push_back(place);
    } else {
      add_proxy(scene, place);
    }
  }
  if (kept) {
    number_instances(scene);
    note_instances(scene);
  }
  scene.notes.push_back(std::to_string(shapes.size()) + " Gaussians with spherical harmonics of degree " +
                        std::to_string(scene.gaussians->degree) +
                        ", each in a proxy of 20 triangles; image.integrator = \"gaussians\" shows them.");
}

}  // namespace marti::scenes
