#include "scenes/polygon_mesh.h"

#include <algorithm>
#include <cmath>

#include "scenes/default_view.h"
#include "scenes/polygon.h"
#include "scenes/vertex_values.h"
#include "sim/error.h"

namespace marti::scenes {

namespace {

/// Whether the corners turn to the left only and go round once.
bool is_convex(std::span<const glm::dvec2> corners) {
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2& b = corners[(i + 1) % n];
    const glm::dvec2& c = corners[(i + 2) % n];
    if (orientation(corners[i], b, c) < 0 || orientation(corners[0], b, c) < 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string PolygonMesh::refusal(std::size_t corners) {
  if (corners < 3 || corners > most_corners) {
    return "a polygon has 3 to " + std::to_string(most_corners) + " corners, this one " +
           std::to_string(corners);
  }
  triangles_ += corners - 2;
  if (triangles_ > file_.options().max_triangles) {
    return "the scene has more than " + std::to_string(file_.options().max_triangles) +
           " triangles, which is more than is accepted";
  }
  return {};
}

bool PolygonMesh::add(std::span<const std::uint32_t> vertices, std::span<const glm::dvec3> positions,
                      std::uint32_t material) {
  const auto polygon = static_cast<std::uint32_t>(scene_.polygons++);
  if (!std::all_of(positions.begin(), positions.end(), is_usable)) {
    ++bad_;
    return false;
  }
  cut(positions);
  for (const auto& [a, b, c] : pieces_) {
    scene_.triangles.push_back({{vertices[a], vertices[b], vertices[c]}, material, polygon});
  }
  return true;
}

void PolygonMesh::cut(std::span<const glm::dvec3> positions) {
  if (positions.size() == 3) {
    cut_fan(3);
    return;
  }
  glm::dvec3 normal(0.0);
  bool has_area = false;
  for (std::size_t i = 1; i + 1 < positions.size(); ++i) {
    const glm::dvec3 part = glm::cross(positions[i] - positions[0], positions[i + 1] - positions[0]);
    has_area |= part != glm::dvec3(0.0);
    normal += part;
  }
  const bool faces = flatten(positions, normal);
  if (!faces || is_convex(flat_)) {
    crossing_ += !faces && has_area ? 1U : 0U;
    cut_fan(positions.size());
    return;
  }
  try {
    pieces_ = triangulate(flat_);
  } catch (const sim::UserError&) {
    ++crossing_;
    cut_fan(positions.size());
  }
}

/// Drops the axis along which the polygon faces, so that its corners are counter-clockwise. False if it faces
/// nowhere.
bool PolygonMesh::flatten(std::span<const glm::dvec3> positions, const glm::dvec3& normal) {
  const glm::dvec3 size(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z));
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (!(size[axis] > 0.0)) {
    return false;
  }
  const int first = (axis + (normal[axis] > 0.0 ? 1 : 2)) % 3;
  const int second = (axis + (normal[axis] > 0.0 ? 2 : 1)) % 3;
  flat_.clear();
  for (const glm::dvec3& position : positions) {
    flat_.emplace_back(position[first], position[second]);
  }
  return true;
}

void PolygonMesh::cut_fan(std::size_t corners) {
  pieces_.clear();
  for (std::uint32_t i = 1; i + 1 < corners; ++i) {
    pieces_.push_back({0, i, i + 1});
  }
}

void PolygonMesh::finish(const LeftOut& left_out) {
  if (scene_.triangles.empty()) {
    if (bad_ == 0) {
      file_.fail_empty();
    }
    file_.fail("none of its polygons has positions that are finite and not beyond 1e30");
  }
  scene_.name = file_.path().filename().string();
  scene_.framed = true;
  set_view(scene_, file_.options());
  note_left_out(left_out, scene_);
  note_bad_positions(bad_, "polygons", scene_);
  if (crossing_ > 0) {
    scene_.notes.push_back(std::to_string(crossing_) + " of " + std::to_string(scene_.polygons) +
                           " polygons cross themselves; each is cut into a fan from its first corner.");
  }
  note_degenerate(scene_);
}

}  // namespace marti::scenes
