// SPD mount(n): a fractal mountain of 2 * 4^n triangles under four glass balls.
//
// The square is split at its middle n times; each new height is the mean of its neighbours plus a normal
// deviate from a generator seeded by the place alone, so that neighbouring cells agree.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "scenes/spd.h"

namespace marti::scenes::spd {

namespace {

/// A normal deviate from a seed (Marsaglia and Bray's polar method over a linear congruential generator).
double gauss(std::uint32_t seed) {
  constexpr std::uint32_t modulus = 134456;
  std::uint32_t b = seed;
  for (;;) {
    const std::uint32_t a = (28411 + 8121 * b) % modulus;
    b = (28411 + 8121 * a) % modulus;
    const double u = 2.0 * a / modulus - 1.0;
    const double v = 2.0 * b / modulus - 1.0;
    const double r = u * u + v * v;
    if (r > 0.0 && r < 1.0) {
      return u * std::sqrt(-2.0 * std::log(r) / r);
    }
  }
}

class Mountain {
 public:
  Mountain(Scene& scene, std::uint32_t n)
      : scene_(scene),
        n_(n),
        cells_(1U << n),
        vertices_(scene),
        height_(std::size_t{cells_ + 1} * (cells_ + 1)) {
    const double q = 2.0 / std::pow(2.0, 1.0 / 1.2);  // fractal dimension 2.2
    roughness_ = std::sqrt(q * q - 1.0);
  }

  void build() { split(0, 0, cells_); }

 private:
  double& height(std::uint32_t a, std::uint32_t b) { return height_[std::size_t{b} * (cells_ + 1) + a]; }

  [[nodiscard]] double deviate(std::uint32_t a, std::uint32_t b) const {
    return gauss(21 + (((a << (23 - n_)) + (b << (15 - n_)) + (a << (7 - n_))) & 0xffffU));
  }

  /// Splits the square cell of `width` whose lower left corner is (a, b). Neighbours compute the middle of
  /// their common edge twice, with the same result.
  void split(std::uint32_t a, std::uint32_t b, std::uint32_t width) {
    if (width == 1) {
      add_cell(a, b);
      return;
    }
    const std::uint32_t half = width / 2;
    const double rise = half * (2.0 / cells_) * roughness_;
    const double ll = height(a, b);
    const double lr = height(a + width, b);
    const double ur = height(a + width, b + width);
    const double ul = height(a, b + width);
    const auto middle = [&](double one, double other, std::uint32_t x, std::uint32_t y) {
      height(x, y) = 0.5 * (one + other) + rise * deviate(x, y);
    };
    middle(ll, lr, a + half, b);
    middle(lr, ur, a + width, b + half);
    middle(ul, ur, a + half, b + width);
    middle(ll, ul, a, b + half);
    height(a + half, b + half) = 0.25 * (ll + lr + ur + ul) + 1.4142136 * rise * deviate(a + half, b + half);
    split(a, b, half);
    split(a + half, b, half);
    split(a + half, b + half, half);
    split(a, b + half, half);
  }

  void add_cell(std::uint32_t a, std::uint32_t b) {
    const auto vertex = [&](std::uint32_t x, std::uint32_t y) {
      return vertices_.add({2.0 * x / cells_ - 1.0, 2.0 * y / cells_ - 1.0, height(x, y)});
    };
    const std::uint32_t ll = vertex(a, b);
    const std::uint32_t lr = vertex(a + 1, b);
    const std::uint32_t ur = vertex(a + 1, b + 1);
    const std::uint32_t ul = vertex(a, b + 1);
    for (const std::array<std::uint32_t, 3>& corners : {std::array{ll, lr, ur}, {ur, ul, ll}}) {
      scene_.triangles.push_back({corners, 0, static_cast<std::uint32_t>(scene_.polygons++)});
    }
  }

  Scene& scene_;
  std::uint32_t n_;
  std::uint32_t cells_;
  VertexWelder vertices_;
  std::vector<double> height_;
  double roughness_ = 0.0;
};

void add_glass_balls(Scene& scene, std::uint32_t material) {
  constexpr double radius = 0.17;
  const glm::dvec3 middle(-0.8, 0.8, 1.0);
  const glm::dvec3 first(0.0, 0.0, radius * std::sqrt(1.5));
  add_sphere(scene, middle + first, radius, material);
  const double d = 1.0 / std::numbers::sqrt2;
  const glm::dvec3 lower = turned(first, {d, d, 0.0}, std::acos(-1.0 / 3.0));
  for (int i = 0; i < 3; ++i) {
    add_sphere(scene, middle + turned(lower, {0.0, 0.0, 1.0}, i * 2.0 * std::numbers::pi / 3.0), radius,
               material);
  }
}

}  // namespace

Scene make_mount(std::uint32_t n) {
  Scene scene = make_scene({-1.6, 1.6, 1.7}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
  const glm::dvec3 light(-100.0, -100.0, 100.0);
  set_lights(scene, {&light, 1});
  add_material(scene, make_material("rock", {0.5, 0.45, 0.35}, 1.0));
  Material glass = make_material("glass", {1.0, 1.0, 1.0}, 0.1, 0.1, 0.4, 6.7);
  glass.transmission = 0.9;
  glass.ior = 1.5;
  Mountain(scene, n).build();
  add_glass_balls(scene, add_material(scene, glass));
  return scene;
}

}  // namespace marti::scenes::spd
