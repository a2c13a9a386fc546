// A closed, convex mesh: no ray from inside may leave it, and no ray from its surface may hit it again.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace marti::tests {

/// An icosahedron, each face cut into four `times` times, on the unit sphere.
struct Icosphere {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;

  explicit Icosphere(int times) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-g, g}) {
        vertices.push_back(glm::normalize(glm::dvec3(a, b, 0)));
        vertices.push_back(glm::normalize(glm::dvec3(0, a, b)));
        vertices.push_back(glm::normalize(glm::dvec3(b, 0, a)));
      }
    }
    // The faces are the triples of mutual neighbours.
    const double edge = 2.0 / std::sqrt(1.0 + g * g) + 1e-9;
    const auto near = [&](std::uint32_t i, std::uint32_t j) {
      return glm::distance(vertices[i], vertices[j]) < edge;
    };
    for (std::uint32_t i = 0; i < 12; ++i) {
      for (std::uint32_t j = i + 1; j < 12; ++j) {
        for (std::uint32_t k = j + 1; k < 12; ++k) {
          if (near(i, j) && near(j, k) && near(i, k)) {
            faces.push_back({i, j, k});
          }
        }
      }
    }
    for (int t = 0; t < times; ++t) {
      refine();
    }
  }

  void refine() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const auto [at, added] =
          middles.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(vertices.size()));
      if (added) {
        vertices.push_back(glm::normalize(vertices[i] + vertices[j]));
      }
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
};

}  // namespace marti::tests
