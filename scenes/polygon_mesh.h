// Internal to scenes/: polygons of files of one mesh (OBJ, PLY) as triangles of a scene, and what such a file
// lacks: a camera and lights.
//
// A convex polygon becomes a fan from its first corner, as in other programs. Others are cut along diagonals
// that lie inside (scenes/polygon.h), seen along the polygon's mean normal (M. E. Newell; see F. Tampieri,
// Newell's Method for Computing the Plane Equation of a Polygon, Graphics Gems III, 1992). One that crosses
// itself has no such diagonals: it becomes a fan too, and a note counts these.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scenes/scene.h"
#include "scenes/scene_notes.h"
#include "scenes/source_file.h"

namespace marti::scenes {

class PolygonMesh {
 public:
  /// The time to cut a polygon grows with the square of its corners, of one that crosses itself with their
  /// cube, so these are limited.
  static constexpr std::size_t most_corners = 1024;

  /// Both must outlive this object.
  PolygonMesh(const SourceFile& file, Scene& scene) : file_(file), scene_(scene) {}

  /// Counts a polygon and returns why it cannot be accepted; empty if it can.
  [[nodiscard]] std::string refusal(std::size_t corners);

  /// Adds a polygon that was counted. It is left out, and false returned, when a position is not finite or
  /// beyond 1e30. `vertices` become the numbers in the scene's triangles.
  bool add(std::span<const std::uint32_t> vertices, std::span<const glm::dvec3> positions,
           std::uint32_t material);

  /// Gives the scene a camera, a light if the options ask for one, and its notes. Throws UserError when it
  /// has no triangles.
  void finish(const LeftOut& left_out);

 private:
  void cut(std::span<const glm::dvec3> positions);
  bool flatten(std::span<const glm::dvec3> positions, const glm::dvec3& normal);
  void cut_fan(std::size_t corners);

  const SourceFile& file_;
  Scene& scene_;
  std::uint64_t triangles_ = 0;  // of all polygons counted
  std::uint64_t bad_ = 0;
  std::uint64_t crossing_ = 0;
  std::vector<glm::dvec2> flat_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
};

}  // namespace marti::scenes
