// SPD tree(n): a bare tree after Aono and Kunii (IEEE CG&A 4(5), 1984): 2^(n + 1) - 1 tapering branches, each
// with a sphere at its tip, on a field.
#include <array>
#include <numbers>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

constexpr double radians = std::numbers::pi / 180.0;
constexpr double taper = 0.67;

/// The position and size of a branch relative to its parent.
struct Fork {
  double bend;
  double turn;
  double shrink;
};
constexpr std::array<Fork, 2> forks = {Fork{40.0, 90.0, 0.65}, Fork{25.0, 230.0, 0.70}};

/// A branch's own frame in the world: its origin and its three axes.
struct Frame {
  glm::dvec3 origin{0.0};
  glm::dvec3 x{1.0, 0.0, 0.0};
  glm::dvec3 y{0.0, 1.0, 0.0};
  glm::dvec3 z{0.0, 0.0, 1.0};

  [[nodiscard]] glm::dvec3 vector(const glm::dvec3& v) const { return v.x * x + v.y * y + v.z * z; }

  /// The frame of a branch that begins at this one's tip: bent about x, rotated about z, scaled.
  [[nodiscard]] Frame forked(const Fork& fork) const {
    const auto axis = [&](const glm::dvec3& v) {
      const glm::dvec3 bent = turned(v, {1.0, 0.0, 0.0}, fork.bend * radians);
      return vector(fork.shrink * turned(bent, {0.0, 0.0, 1.0}, fork.turn * radians));
    };
    return {origin + z, axis({1.0, 0.0, 0.0}), axis({0.0, 1.0, 0.0}), axis({0.0, 0.0, 1.0})};
  }
};

/// Depth n <= 17 bounds the recursion.
void add_branch(Scene& scene, std::uint32_t n, const Frame& frame, double size) {
  const double radius = 0.15 * size;
  const glm::dvec3 tip = frame.origin + frame.z;
  add_cone(scene, frame.origin, tip, radius, taper * radius, 1);
  add_sphere(scene, tip, taper * radius, 1);
  if (n > 0) {
    for (const Fork& fork : forks) {
      add_branch(scene, n - 1, frame.forked(fork), size * taper);
    }
  }
}

}  // namespace

Scene make_tree(std::uint32_t n) {
  Scene scene = make_scene({4.5, 0.4, 2.0}, {0.0, 0.0, 1.5}, {0.0, 0.0, 1.0});
  constexpr std::array<glm::dvec3, 7> lights = {glm::dvec3{-5.0, 5.0, 50.0},    glm::dvec3{30.0, -30.0, 30.0},
                                                glm::dvec3{-40.0, -30.0, 20.0}, glm::dvec3{10.0, 30.0, 40.0},
                                                glm::dvec3{-30.0, 40.0, 10.0},  glm::dvec3{50.0, 25.0, 20.0},
                                                glm::dvec3{-10.0, -60.0, 30.0}};
  set_lights(scene, lights);
  const std::uint32_t field = add_material(scene, make_material("field", {0.2, 0.7, 0.2}, 1.0));
  add_material(scene, make_material("wood", {0.55, 0.4, 0.2}, 1.0));
  add_square(scene, {{{50.0, 50.0, 0.0}, {-50.0, 50.0, 0.0}, {-50.0, -50.0, 0.0}, {50.0, -50.0, 0.0}}},
             field);
  add_branch(scene, n, {}, 1.0);
  return scene;
}

}  // namespace marti::scenes::spd
