// Counts the contents of a scene.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <sstream>

#include <glm/geometric.hpp>

#include "scenes/open.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

using PositionBits = std::array<std::uint64_t, 3>;

PositionBits bits_of(const glm::dvec3& p) {
  // + 0.0 turns -0 into +0, so that both are one position.
  return {std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
          std::bit_cast<std::uint64_t>(p.z + 0.0)};
}

/// For each vertex the rank of its position among the different positions.
std::vector<std::uint32_t> position_ranks(const Scene& scene) {
  std::vector<std::pair<PositionBits, std::uint32_t>> sorted;
  sorted.reserve(scene.positions.size());
  for (std::size_t i = 0; i < scene.positions.size(); ++i) {
    sorted.emplace_back(bits_of(scene.positions[i]), static_cast<std::uint32_t>(i));
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> ranks(sorted.size());
  std::uint32_t rank = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    rank += i > 0 && sorted[i].first != sorted[i - 1].first ? 1U : 0U;
    ranks[sorted[i].second] = rank;
  }
  return ranks;
}

std::string text_of(const glm::dvec3& v) {
  std::ostringstream out;
  out << "(" << v.x << ", " << v.y << ", " << v.z << ")";
  return out.str();
}

}  // namespace

bool has_no_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto largest = [](const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  const double edge = std::max(largest(b - a), largest(c - a));
  return !(largest(glm::cross(b - a, c - a)) * edge >= std::numeric_limits<double>::min());
}

std::uint64_t count_degenerate(const Scene& scene) {
  const auto degenerate = [&p = scene.positions](const Triangle& triangle) {
    return has_no_area(p[triangle.vertex[0]], p[triangle.vertex[1]], p[triangle.vertex[2]]);
  };
  return static_cast<std::uint64_t>(
      std::count_if(scene.triangles.begin(), scene.triangles.end(), degenerate));
}

std::uint64_t host_bytes(const Scene& scene) {
  std::uint64_t bytes = scene.positions.size() * sizeof(glm::dvec3) +
                        scene.normals.size() * sizeof(glm::dvec3) + scene.uvs.size() * sizeof(glm::dvec2) +
                        scene.triangles.size() * sizeof(Triangle) + scene.quadrics.size() * sizeof(Quadric) +
                        scene.instances.size() * sizeof(InstancePlace) +
                        scene.rays.rays.size() * sizeof(GivenRay) + scene.rays.any.size() / 8;
  if (scene.gaussians != nullptr) {
    bytes += scene.gaussians->shapes.size() * sizeof(Gaussian) +
             scene.gaussians->coefficients.size() * sizeof(float);
  }
  for (const Texture& texture : scene.textures) {
    bytes += texture.texels.size() * sizeof(texture.texels[0]) +
             (texture.file == nullptr ? 0 : texture.file->size());
  }
  return bytes;
}

std::uint64_t host_bytes_of_facts(const Scene& scene) {
  // For each vertex its position with its number, and its rank; for each triangle its corners, in a vector
  // that grows by doubling, and its key.
  const std::uint64_t vertex = sizeof(PositionBits) + 8 + 4;
  const std::uint64_t triangle = 3 * (3 * 4) + 3 * 4;
  return scene.positions.size() * vertex + scene.triangles.size() * triangle;
}

SceneFacts facts_of(const Scene& scene) {
  SceneFacts facts;
  facts.name = scene.name;
  facts.polygons = scene.polygons;
  facts.triangles = scene.triangles.size();
  for (const Quadric& quadric : scene.quadrics) {
    ++(quadric.kind == QuadricKind::sphere     ? facts.spheres
       : quadric.kind == QuadricKind::cylinder ? facts.cylinders
                                               : facts.cones);
  }
  facts.vertices = scene.positions.size();
  facts.materials = scene.materials.size();
  facts.textures = scene.textures.size();
  facts.lights = scene.lights.size();
  facts.bounds = bounds_of(scene);
  facts.degenerate_triangles = count_degenerate(scene);
  for (const Texture& texture : scene.textures) {
    facts.texels += texture.size();
  }
  const std::vector<std::uint32_t> ranks = position_ranks(scene);
  std::vector<std::uint32_t> used;
  std::vector<std::array<std::uint32_t, 3>> keys;
  keys.reserve(scene.triangles.size());
  for (const Triangle& triangle : scene.triangles) {
    std::array<std::uint32_t, 3> key = {ranks[triangle.vertex[0]], ranks[triangle.vertex[1]],
                                        ranks[triangle.vertex[2]]};
    used.insert(used.end(), key.begin(), key.end());
    std::sort(key.begin(), key.end());
    keys.push_back(key);
  }
  std::sort(used.begin(), used.end());
  facts.distinct_positions = static_cast<std::uint64_t>(std::unique(used.begin(), used.end()) - used.begin());
  std::sort(keys.begin(), keys.end());
  facts.duplicate_triangles =
      keys.size() - static_cast<std::uint64_t>(std::unique(keys.begin(), keys.end()) - keys.begin());
  return facts;
}

std::string describe(const Scene& scene) {
  const SceneFacts facts = facts_of(scene);
  std::ostringstream out;
  out << "scene: " << sim::shown(facts.name) << "\n"
      << "polygons: " << facts.polygons << "\n"
      << "triangles: " << facts.triangles << "\n"
      << "spheres: " << facts.spheres << "\n"
      << "cylinders: " << facts.cylinders << "\n"
      << "cones: " << facts.cones << "\n"
      << "vertices: " << facts.vertices << " (" << facts.distinct_positions << " distinct positions in use)\n"
      << "degenerate triangles: " << facts.degenerate_triangles << "\n"
      << "duplicate triangles: " << facts.duplicate_triangles << "\n"
      << "materials: " << facts.materials << "\n"
      << "textures: " << facts.textures << " (" << facts.texels << " texels)\n"
      << "lights: " << facts.lights << "\n";
  if (facts.bounds.empty()) {
    out << "bounds: none\n";
  } else {
    out << "bounds: " << text_of(facts.bounds.lo) << " to " << text_of(facts.bounds.hi) << "\n";
  }
  out << "camera: at " << text_of(scene.camera.eye) << " looking at " << text_of(scene.camera.at) << "\n";
  for (const std::string& note : scene.notes) {
    out << "note: " << note << "\n";
  }
  return out.str();
}

}  // namespace marti::scenes
