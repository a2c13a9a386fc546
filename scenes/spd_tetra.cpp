// SPD tetra(n): a Sierpinski tetrahedron of 4^n triangles.
#include <array>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

// The cube's corners whose signs multiply to +1 span a regular tetrahedron.
constexpr std::array<glm::dvec3, 4> corners = {glm::dvec3{-1, -1, 1}, glm::dvec3{-1, 1, -1},
                                               glm::dvec3{1, -1, -1}, glm::dvec3{1, 1, 1}};
constexpr std::array<std::array<std::size_t, 3>, 4> faces = {{{0, 1, 2}, {3, 2, 1}, {2, 3, 0}, {1, 0, 3}}};

/// Depth n <= 12 bounds the recursion. All coordinates are multiples of 2^-n, hence exact.
void add_tetrahedra(Scene& scene, VertexWelder& vertices, std::uint32_t n, const glm::dvec3& center,
                    double half_width) {
  if (n > 1) {
    for (const glm::dvec3& corner : corners) {
      add_tetrahedra(scene, vertices, n - 1, center + corner * (half_width / 2.0), half_width / 2.0);
    }
    return;
  }
  for (const auto& face : faces) {
    Triangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.vertex[i] = vertices.add(center + corners[face[i]] * half_width);
    }
    triangle.polygon = static_cast<std::uint32_t>(scene.polygons++);
    scene.triangles.push_back(triangle);
  }
}

}  // namespace

Scene make_tetra(std::uint32_t n) {
  Scene scene = make_scene({1.022846, -3.177154, -2.174512}, {-0.004103, -0.004103, 0.216539},
                           {-0.816497, -0.816497, 0.816497});
  const glm::dvec3 light(2.0, -18.0, -5.0);
  set_lights(scene, {&light, 1});
  Material material;
  material.name = "tetrahedra";
  material.color = {1.0, 0.2, 0.2};
  scene.materials.push_back(material);
  VertexWelder vertices(scene);
  add_tetrahedra(scene, vertices, n, glm::dvec3(0.0), 1.0);
  return scene;
}

}  // namespace marti::scenes::spd
