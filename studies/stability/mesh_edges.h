// How the triangles of a scene meet, and rays that must not pass between them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "accel/ray.h"
#include "accel/triangles.h"
#include "studies/stability/hostile_rays.h"

namespace marti::studies::stability {

/// The triangles of a set by the corners that they share bit for bit.
class MeshEdges {
 public:
  /// `triangles` must outlive the object.
  explicit MeshEdges(const accel::TriangleSet& triangles);

  /// Edges that only one triangle has, and all edges.
  [[nodiscard]] std::uint64_t open_edges() const { return open_; }
  [[nodiscard]] std::uint64_t edges() const { return all_; }

  /// The one other triangle that shares the edge between two corners of a triangle, the first corner and the
  /// next; std::nullopt if there is none or if there are several.
  [[nodiscard]] std::optional<std::uint32_t> neighbour(std::uint32_t triangle, unsigned first) const;
  /// Which corner of the triangle `other` is not on that edge.
  [[nodiscard]] unsigned third(std::uint32_t triangle, unsigned first, std::uint32_t other) const;

  /// Rays at points of edges that two triangles share, from origins that see the surface continue across the
  /// edge. Each must hit something between its limits, in any arithmetic whose rounding (2^-53 of doubles,
  /// 2^-24 of floats) is `rounding`: places are left out where triangles look narrower than 2^8 roundings of
  /// the numbers there. May be fewer than `count`, even none.
  [[nodiscard]] std::vector<accel::Ray> rays_at_edges(std::uint32_t count, double rounding,
                                                      std::uint64_t seed) const;

 private:
  using Side = std::pair<std::array<std::uint32_t, 2>, std::uint32_t>;  // an edge's corners, and a triangle

  [[nodiscard]] std::optional<accel::Ray> at_edge(std::uint32_t triangle, unsigned first, double rounding,
                                                  const glm::dvec3& origin, double along) const;
  [[nodiscard]] std::uint32_t id(std::uint32_t triangle, unsigned corner) const {
    return ids_[std::size_t{3} * triangle + corner];
  }

  const accel::TriangleSet& triangles_;
  std::vector<std::uint32_t> ids_;  // of each corner of each triangle
  std::vector<Side> sides_;         // sorted
  std::uint64_t open_ = 0;
  std::uint64_t all_ = 0;
};

}  // namespace marti::studies::stability
