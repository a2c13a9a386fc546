#include "scenes/append_geometry.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace marti::scenes {

namespace {

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
  from = {};
}

/// A list that is empty or as long as the positions, and its part for more of them.
template <class T>
void append_attribute(std::vector<T>& to, std::size_t before, std::vector<T>& from, std::size_t more) {
  if (!to.empty() || !from.empty()) {
    to.resize(before, T(0.0));
    from.resize(more, T(0.0));
    append(to, from);
  }
}

}  // namespace

bool fit_together(const Scene& whole, const Scene& part, std::uint64_t most) {
  return whole.triangles.size() + part.triangles.size() <= most &&
         whole.positions.size() + part.positions.size() <= most &&
         whole.quadrics.size() + part.quadrics.size() <= most;
}

void append_geometry(Scene& to, Scene& part, std::uint32_t first_material) {
  const auto vertices = static_cast<std::uint32_t>(to.positions.size());
  const std::uint32_t sources = to.quadrics.empty() ? 0 : to.quadrics.back().source + 1;
  for (Triangle& triangle : part.triangles) {
    for (std::uint32_t& vertex : triangle.vertex) {
      vertex += vertices;
    }
    triangle.material += first_material;
    triangle.polygon += static_cast<std::uint32_t>(to.polygons);
  }
  for (Quadric& quadric : part.quadrics) {
    quadric.material += first_material;
    quadric.source += sources;
  }
  to.polygons += part.polygons;
  append_attribute(to.normals, vertices, part.normals, part.positions.size());
  append_attribute(to.uvs, vertices, part.uvs, part.positions.size());
  append(to.positions, part.positions);
  append(to.triangles, part.triangles);
  append(to.quadrics, part.quadrics);
}

}  // namespace marti::scenes
