#include "scenes/pbrt_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "scenes/placement.h"
#include "scenes/ply.h"
#include "scenes/tessellate.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"

namespace marti::scenes::pbrt {

namespace {

/// The numbers of `name` as points or vectors; `count` of them, unless there are none or `count` is 0.
std::vector<glm::dvec3> vectors(const Parameters& parameters, std::string_view name, std::size_t count) {
  const std::vector<double>& given = parameters.numbers(name, 3);
  if (!given.empty() && count != 0 && given.size() != 3 * count) {
    parameters.fail("the parameter " + in_quotes(name) + " has " + std::to_string(given.size() / 3) +
                    " vectors for " + std::to_string(count) + " points");
  }
  std::vector<glm::dvec3> all;
  all.reserve(given.size() / 3);
  for (std::size_t i = 0; i < given.size(); i += 3) {
    all.emplace_back(given[i], given[i + 1], given[i + 2]);
  }
  return all;
}

std::vector<glm::dvec2> coordinates(const Parameters& parameters, std::size_t count) {
  const std::string_view name = parameters.find("uv") == nullptr ? "st" : "uv";
  const std::vector<double>& given = parameters.numbers(name, 2);
  if (!given.empty() && given.size() != 2 * count) {
    parameters.fail("the parameter " + in_quotes(name) + " has " + std::to_string(given.size() / 2) +
                    " pairs for " + std::to_string(count) + " points");
  }
  std::vector<glm::dvec2> all;
  all.reserve(given.size() / 2);
  for (std::size_t i = 0; i < given.size(); i += 2) {
    all.push_back(turned_coordinates(given[i], given[i + 1]));
  }
  return all;
}

/// Turns triangles whose corners' normals point to the inside.
void turn_to_normals(Scene& mesh) {
  for (Triangle& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle.vertex;
    const std::vector<glm::dvec3>& p = mesh.positions;
    const glm::dvec3 outward = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
    if (glm::dot(outward, glm::cross(p[b] - p[a], p[c] - p[a])) < 0.0) {
      std::swap(triangle.vertex[1], triangle.vertex[2]);
    }
  }
}

/// The coordinates that pbrt gives meshes without any: every face has the whole texture, a triangle the half
/// of it. No two faces share a vertex then. Of two triangles that are one face, the second has the other
/// half.
void set_default_coordinates(Scene& mesh, const SourceFile& file) {
  file.require_memory(mesh.triangles.size() * 3 * (2 * sizeof(glm::dvec3) + sizeof(glm::dvec2)),
                      "its texture coordinates take");
  const glm::dvec2 from = turned_coordinates(0.0, 0.0);
  const glm::dvec2 across = turned_coordinates(1.0, 1.0);
  const std::array<glm::dvec2, 3> first_half = {from, turned_coordinates(1.0, 0.0), across};
  const std::array<glm::dvec2, 3> second_half = {from, across, turned_coordinates(0.0, 1.0)};
  Scene apart;
  std::uint32_t polygon = 0xffffffffU;
  for (Triangle& triangle : mesh.triangles) {
    const bool second = triangle.polygon == std::exchange(polygon, triangle.polygon);
    const std::array<glm::dvec2, 3>& coordinates = second ? second_half : first_half;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& vertex = triangle.vertex[k];
      apart.positions.push_back(mesh.positions[vertex]);
      if (!mesh.normals.empty()) {
        apart.normals.push_back(mesh.normals[vertex]);
      }
      apart.uvs.push_back(coordinates[k]);
      vertex = static_cast<std::uint32_t>(apart.positions.size() - 1);
    }
  }
  mesh.positions = std::move(apart.positions);
  mesh.normals = std::move(apart.normals);
  mesh.uvs = std::move(apart.uvs);
}

/// A mesh of faces of so many corners: three, or the four of a bilinear patch, row by row.
Scene mesh_of(const Parameters& parameters, std::size_t corners, bool with_normals) {
  Scene mesh;
  mesh.positions = vectors(parameters, "P", 0);
  const std::size_t points = mesh.positions.size();
  if (points == 0) {
    parameters.fail("the shape has no points 'P'");
  }
  if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), is_usable)) {
    parameters.fail("a point of 'P' is not finite or beyond 1e30");
  }
  if (with_normals) {
    mesh.normals = vectors(parameters, "N", points);
    for (glm::dvec3& normal : mesh.normals) {
      normal = unit_or_zero(normal);
    }
  }
  mesh.uvs = coordinates(parameters, points);
  std::vector<double> indices = parameters.numbers("indices", corners);
  if (indices.empty() && points == corners) {
    for (std::size_t i = 0; i < corners; ++i) {
      indices.push_back(static_cast<double>(i));
    }
  }
  for (std::size_t i = 0; i < indices.size(); i += corners) {
    std::array<std::uint32_t, 4> corner{};
    for (std::size_t k = 0; k < corners; ++k) {
      const double index = indices[i + k];
      if (!(index >= 0.0 && index < static_cast<double>(points)) || index != std::floor(index)) {
        parameters.fail("an index is none of the numbers 0 to " + std::to_string(points - 1) +
                        " of the points");
      }
      corner[k] = static_cast<std::uint32_t>(index);
    }
    const auto polygon = static_cast<std::uint32_t>(mesh.polygons++);
    mesh.triangles.push_back({{corner[0], corner[1], corner[corners == 3 ? 2 : 3]}, 0, polygon});
    if (corners == 4) {
      mesh.triangles.push_back({{corner[0], corner[3], corner[2]}, 0, polygon});
    }
  }
  return mesh;
}

Scene ply_mesh(const Parameters& parameters, const SourceFile& file, Text& text) {
  FileOptions options = file.options();
  options.view = {};
  options.sky = {};
  options.default_light = DefaultLight::never;
  options.memory = file.memory();
  Scene mesh;
  try {
    mesh = open_ply(text.file(parameters.text("filename")), options).at(0.0);
  } catch (const NoTriangles&) {
    return {};
  }
  if (mesh.gaussians != nullptr) {
    parameters.fail("its PLY file holds Gaussians, which are no shape");
  }
  Scene geometry;
  geometry.positions = std::move(mesh.positions);
  geometry.normals = std::move(mesh.normals);
  geometry.uvs = std::move(mesh.uvs);
  geometry.triangles = std::move(mesh.triangles);
  geometry.polygons = mesh.polygons;
  return geometry;
}

Scene curved(QuadricKind kind, const Parameters& parameters, LeftOut& left_out) {
  Quadric quadric;
  quadric.kind = kind;
  quadric.radius = parameters.number("radius", 1.0, 0.0, largest_coordinate);
  if (kind == QuadricKind::cylinder) {
    quadric.base =
        glm::dvec3(0.0, 0.0, parameters.number("zmin", -1.0, -largest_coordinate, largest_coordinate));
    quadric.tip =
        glm::dvec3(0.0, 0.0, parameters.number("zmax", 1.0, -largest_coordinate, largest_coordinate));
  } else {
    left_out.features["cuts of spheres"] +=
        parameters.find("zmin") != nullptr || parameters.find("zmax") != nullptr ? 1U : 0U;
  }
  left_out.features["angles of round shapes that are not closed"] +=
      parameters.find("phimax") != nullptr ? 1U : 0U;
  check_quadric(quadric, parameters.place() + ": the shape");
  Scene shape;
  shape.quadrics.push_back(quadric);
  return shape;
}

Scene disk(const Parameters& parameters, LeftOut& left_out) {
  const double height = parameters.number("height", 0.0, -largest_coordinate, largest_coordinate);
  const double radius = parameters.number("radius", 1.0, 0.0, largest_coordinate);
  left_out.features["holes of disks"] += parameters.find("innerradius") != nullptr ? 1U : 0U;
  left_out.features["angles of round shapes that are not closed"] +=
      parameters.find("phimax") != nullptr ? 1U : 0U;
  Scene shape;
  for (std::uint32_t i = 0; i < tessellation_sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / tessellation_sides;
    shape.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    if (i >= 2) {
      shape.triangles.push_back({{0, i - 1, i}, 0, 0});
    }
  }
  shape.polygons = 1;
  return shape;
}

}  // namespace

std::optional<Scene> scene_of_shape(const std::string& kind, const Parameters& parameters, bool textured,
                                    const SourceFile& file, Text& text, LeftOut& left_out) {
  const auto finished = [&](Scene mesh) {
    if (textured && mesh.uvs.empty()) {
      set_default_coordinates(mesh, file);
    }
    if (!mesh.normals.empty()) {
      turn_to_normals(mesh);
    }
    return mesh;
  };
  if (kind == "trianglemesh") {
    return finished(mesh_of(parameters, 3, true));
  }
  if (kind == "bilinearmesh") {
    return finished(mesh_of(parameters, 4, true));
  }
  if (kind == "loopsubdiv") {
    left_out.replace("subdivision surfaces, by their control meshes",
                     parameters.place() + ": subdivision surfaces are not supported");
    return finished(mesh_of(parameters, 3, false));
  }
  if (kind == "plymesh") {
    return finished(ply_mesh(parameters, file, text));
  }
  if (kind == "sphere" || kind == "cylinder") {
    return curved(kind == "sphere" ? QuadricKind::sphere : QuadricKind::cylinder, parameters, left_out);
  }
  if (kind == "disk") {
    return disk(parameters, left_out);
  }
  if (kind != "curve") {
    parameters.fail("there is no shape " + in_quotes(kind));
  }
  left_out.features["curves"] += 1;
  return std::nullopt;
}

void to_triangles_if_stretched(Scene& shape, const glm::dmat4& transform) {
  if (!shape.quadrics.empty() && common_scale(glm::dmat3(transform)) == 0.0) {
    tessellate(shape);
  }
}

}  // namespace marti::scenes::pbrt
