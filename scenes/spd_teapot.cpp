// SPD teapot(n): Newell's 32 patches, each cut into n x n quadrilaterals, on a chequered board.
#include <array>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "scenes/spd.h"
#include "scenes/teapot_patches.h"

namespace marti::scenes::spd {

namespace {

using Patch = std::array<std::array<glm::dvec3, 4>, 4>;

/// The Bernstein basis of degree 3 and its derivative at i/n. Written so that i and n - i give the same
/// numbers in reverse: patches that run along a common edge in opposite directions agree bit for bit.
struct Basis {
  std::array<double, 4> value;
  std::array<double, 4> slope;
  Basis(std::uint32_t i, std::uint32_t n) {
    const double u = static_cast<double>(i) / n;
    const double w = static_cast<double>(n - i) / n;
    value = {w * w * w, 3.0 * (u * w) * w, 3.0 * (u * w) * u, u * u * u};
    slope = {-3.0 * w * w, 3.0 * w * w - 6.0 * u * w, 6.0 * u * w - 3.0 * u * u, 3.0 * u * u};
  }
};

glm::dvec3 blend(const std::array<double, 4>& weight, const std::array<glm::dvec3, 4>& point) {
  return (weight[0] * point[0] + weight[3] * point[3]) + (weight[1] * point[1] + weight[2] * point[2]);
}

/// A point of the curve. If the four points agree in a coordinate, so does the curve, without rounding: the
/// points of a degenerate edge stay one point, and a level rim stays level.
glm::dvec3 curve_at(const std::array<double, 4>& weight, const std::array<glm::dvec3, 4>& point) {
  glm::dvec3 result = blend(weight, point);
  for (int axis = 0; axis < 3; ++axis) {
    if (point[0][axis] == point[1][axis] && point[0][axis] == point[2][axis] &&
        point[0][axis] == point[3][axis]) {
      result[axis] = point[0][axis];
    }
  }
  return result;
}

glm::dvec3 surface_at(const Basis& s, const Basis& t, const Patch& patch) {
  return curve_at(s.value, {curve_at(t.value, patch[0]), curve_at(t.value, patch[1]),
                            curve_at(t.value, patch[2]), curve_at(t.value, patch[3])});
}

glm::dvec3 blend(const std::array<double, 4>& rows, const std::array<double, 4>& columns,
                 const Patch& patch) {
  return blend(rows, {blend(columns, patch[0]), blend(columns, patch[1]), blend(columns, patch[2]),
                      blend(columns, patch[3])});
}

bool on_axis(const glm::dvec3& p) { return std::abs(p.x) < 1e-4 && std::abs(p.y) < 1e-4; }

/// The normal; at the lid's tip and the bottom's centre, where the patch is degenerate, it is the axis.
glm::dvec3 normal_at(const Basis& s, const Basis& t, const Patch& patch, const glm::dvec3& position) {
  const glm::dvec3 normal = glm::cross(blend(s.value, t.slope, patch), blend(s.slope, t.value, patch));
  if (on_axis(position) || !(glm::length(normal) > 0.0)) {
    return {0.0, 0.0, position.z > 1.0 ? 1.0 : -1.0};
  }
  return glm::normalize(normal);
}

void add_patch(Scene& scene, VertexWelder& vertices, const Patch& patch, std::uint32_t n) {
  std::vector<std::uint32_t> grid;
  grid.reserve(std::size_t{n + 1} * (n + 1));
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      const Basis s(i, n);
      const Basis t(j, n);
      const glm::dvec3 position = surface_at(s, t, patch);
      grid.push_back(vertices.add(position, normal_at(s, t, patch, position)));
    }
  }
  const auto add_triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const int axial = static_cast<int>(on_axis(scene.positions[a])) +
                      static_cast<int>(on_axis(scene.positions[b])) +
                      static_cast<int>(on_axis(scene.positions[c]));
    if (axial <= 1) {
      scene.triangles.push_back({{a, b, c}, 0, static_cast<std::uint32_t>(scene.polygons++)});
    }
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::size_t row = std::size_t{i} * (n + 1);
      const std::size_t below = row + n + 1;
      add_triangle(grid[row + j], grid[row + j + 1], grid[below + j + 1]);
      add_triangle(grid[below + j + 1], grid[below + j], grid[row + j]);
    }
  }
}

void add_board(Scene& scene, VertexWelder& vertices, std::uint32_t n) {
  const auto coordinate = [n](std::uint32_t i) { return -4.0 + 8.0 * i / n; };
  const glm::dvec3 up(0.0, 0.0, 1.0);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t material = (i + j) % 2 == 1 ? 1 : 2;
      const auto polygon = static_cast<std::uint32_t>(scene.polygons++);
      const std::uint32_t a = vertices.add({coordinate(i), coordinate(j), 0.0}, up);
      const std::uint32_t b = vertices.add({coordinate(i + 1), coordinate(j), 0.0}, up);
      const std::uint32_t c = vertices.add({coordinate(i + 1), coordinate(j + 1), 0.0}, up);
      const std::uint32_t d = vertices.add({coordinate(i), coordinate(j + 1), 0.0}, up);
      scene.triangles.push_back({{a, b, c}, material, polygon});
      scene.triangles.push_back({{c, d, a}, material, polygon});
    }
  }
}

}  // namespace

Scene make_teapot(std::uint32_t n, bool with_board) {
  Scene scene = make_scene({4.86, 7.2, 5.4}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
  constexpr std::array<glm::dvec3, 2> lights = {glm::dvec3{-3.1, 9.8, 12.1}, glm::dvec3{11.3, 5.1, 8.8}};
  set_lights(scene, lights);
  scene.materials.push_back(make_material("pot", {1.0, 0.5, 0.1}, 0.75, 0.25, 0.25, 37.0));
  VertexWelder vertices(scene);
  for (const auto& indices : teapot_patches) {
    Patch patch;
    for (std::size_t i = 0; i < 16; ++i) {
      const std::array<double, 3>& point = teapot_points[indices[i]];
      patch[i / 4][i % 4] = {point[0], point[1], point[2]};
    }
    add_patch(scene, vertices, patch, n);
  }
  if (with_board) {
    scene.materials.push_back(make_material("board white", {1.0, 1.0, 1.0}, 0.5, 0.5, 0.5, 30.0));
    scene.materials.push_back(make_material("board grey", {0.5, 0.5, 0.5}, 0.5, 0.5, 0.5, 30.0));
    add_board(scene, vertices, n);
  }
  return scene;
}

}  // namespace marti::scenes::spd
