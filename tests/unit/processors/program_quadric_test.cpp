// Shading points on spheres, cylinders and cones, and the rays that leave them.
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "processors/program/quadric_surface.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/support/long_tests.h"

namespace marti::processors {

using namespace program;

namespace {

using scenes::Quadric;
using scenes::QuadricKind;

class Directions {
 public:
  explicit Directions(std::uint64_t seed) : random_(seed) {}
  glm::dvec3 any() {
    return glm::normalize(glm::dvec3(normal_(random_), normal_(random_), normal_(random_)));
  }
  double unit() { return unit_(random_); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> unit_;
};

glm::dvec3 plain(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

scenes::Scene scene_of(const std::vector<Quadric>& quadrics) {
  scenes::Scene scene = test::looking_down(10.0);
  scene.materials.emplace_back();
  scene.quadrics = quadrics;
  return scene;
}

/// Where a ray hits, made ready for shading.
Surface<double> surface_of(const test::Built& built, const accel::Ray& ray, const accel::Hit& hit) {
  return quadric_surface(built.triangles->quadric(hit.primitive),
                         Vec3<double>(ray.origin + hit.t * ray.direction), Vec3<double>(ray.direction));
}

accel::Ray leaving(const Surface<double>& surface, const glm::dvec3& direction) {
  accel::Ray ray{plain(leave(surface, Vec3<double>(direction))), direction};
  ray.t_min = std::numeric_limits<double>::denorm_min();
  return ray;
}

/// A scale and an offset in scales.
class LeavingQuadrics : public testing::TestWithParam<std::tuple<double, double>> {};

// Outwards nothing is hit, however flat the ray; inwards the far side, where a chord ends.
TEST_P(LeavingQuadrics, SpheresDoNotShadowThemselves) {
  const auto [scale, offset] = GetParam();
  const glm::dvec3 center(offset * scale, -0.5 * offset * scale, 0.25 * offset * scale);
  const test::Built built(scene_of({{.kind = QuadricKind::sphere, .base = center, .radius = scale}}),
                          "octree");
  Directions random(7);
  for (int i = 0; i < marti::test::cases(20000); ++i) {
    const glm::dvec3 eye = center + random.any() * (scale * (1.5 + 9.0 * random.unit()));
    // Grazing hits too.
    const glm::dvec3 aim = center + random.any() * (0.9999 * scale);
    const accel::Ray ray{eye, glm::normalize(aim - eye)};
    const accel::Hit hit = built.structure->closest(ray);
    ASSERT_TRUE(hit.found());
    const Surface<double> surface = surface_of(built, ray, hit);
    ASSERT_TRUE(surface.outside);
    const glm::dvec3 normal = plain(surface.geometric);
    ASSERT_NEAR(glm::length(normal), 1.0, 1e-14);
    glm::dvec3 out = random.any();
    if (i % 4 == 0) {  // along the surface
      out = glm::normalize(glm::cross(normal, out)) + std::ldexp(1.0, -i % 60) * normal;
    }
    out = glm::dot(out, normal) < 0.0 ? -out : out;
    ASSERT_FALSE(built.structure->occluded(leaving(surface, out)))
        << "a ray hits the sphere it leaves, " << i;
    const double cosine = glm::dot(out, normal) / glm::length(out);
    if (cosine > 1e-3) {
      const accel::Ray inward = leaving(surface, -out);
      const accel::Hit far = built.structure->closest(inward);
      ASSERT_TRUE(far.found()) << "a ray into the sphere passes the far side";
      ASSERT_NEAR(far.t * glm::length(out), 2.0 * scale * cosine, 1e-5 * scale + 1e-15 * glm::length(center));
      ASSERT_FALSE(surface_of(built, inward, far).outside);
    }
  }
}

TEST_P(LeavingQuadrics, CylindersAndConesDoNotShadowThemselves) {
  const auto [scale, offset] = GetParam();
  const glm::dvec3 base(offset * scale, 0.5 * offset * scale, -0.25 * offset * scale);
  for (const auto& [radius, tip_radius] :
       {std::pair{0.3, 0.3}, std::pair{0.01, 0.01}, std::pair{0.3, 0.1}, std::pair{1.0, 0.02}}) {
    const test::Built built(scene_of({{.kind = QuadricKind::cone,
                                       .base = base,
                                       .tip = base + scale * glm::dvec3(0.3, -0.5, 0.9),
                                       .radius = radius * scale,
                                       .tip_radius = tip_radius * scale}}),
                            "octree");
    const accel::QuadricShape& shape = built.triangles->quadric(0);
    const glm::dvec3 center(shape.center[0], shape.center[1], shape.center[2]);
    const glm::dvec3 axis(shape.axis[0], shape.axis[1], shape.axis[2]);
    Directions random(11);
    int outwards = 0;
    for (int i = 0; i < marti::test::cases(5000); ++i) {
      const glm::dvec3 aim = center + (2.0 * random.unit() - 1.0) * shape.half * axis;
      const glm::dvec3 eye = aim + 3.0 * scale * random.any();
      const accel::Ray ray{eye, glm::normalize(aim - eye)};
      const accel::Hit hit = built.structure->closest(ray);
      if (!hit.found()) {
        continue;  // through an open end
      }
      const Surface<double> surface = surface_of(built, ray, hit);
      const glm::dvec3 normal = plain(surface.geometric);
      ASSERT_NEAR(glm::length(normal), 1.0, 1e-14);
      if (!surface.outside) {
        continue;
      }
      ++outwards;
      glm::dvec3 out = random.any();
      if (i % 4 == 0) {
        out = glm::normalize(glm::cross(normal, out)) + std::ldexp(1.0, -i % 60) * normal;
      }
      out = glm::dot(out, normal) < 0.0 ? -out : out;
      ASSERT_FALSE(built.structure->occluded(leaving(surface, out)))
          << radius << " " << tip_radius << " " << i;
    }
    EXPECT_GT(outwards, marti::test::cases(2000));
  }
}

INSTANTIATE_TEST_SUITE_P(Scales, LeavingQuadrics,
                         testing::Values(std::tuple(1.0, 0.0), std::tuple(1e-6, 0.0), std::tuple(1e6, 0.0),
                                         std::tuple(1.0, 1e3), std::tuple(1e-6, 1e6), std::tuple(1e6, 1e3),
                                         std::tuple(1e-3, 1e5)));

TEST(QuadricSurface, NormalsPointAwayFromTheAxisOnTheViewersSide) {
  const test::Built built(scene_of({{.kind = QuadricKind::cone,
                                     .base = {0.0, 0.0, -1.0},
                                     .tip = {0.0, 0.0, 1.0},
                                     .radius = 2.0,
                                     .tip_radius = 0.0}}));
  const accel::Ray outside{{9.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}};
  const Surface<double> front = surface_of(built, outside, built.structure->closest(outside));
  EXPECT_TRUE(front.outside);
  EXPECT_NEAR(front.point.x, 1.0, 1e-15);
  EXPECT_NEAR(front.geometric.x, std::numbers::sqrt2 / 2.0, 1e-15);  // a slope of 45 degrees
  EXPECT_NEAR(front.geometric.z, std::numbers::sqrt2 / 2.0, 1e-15);
  const accel::Ray inside{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  const Surface<double> back = surface_of(built, inside, built.structure->closest(inside));
  EXPECT_FALSE(back.outside);
  EXPECT_NEAR(back.geometric.x, -std::numbers::sqrt2 / 2.0, 1e-15);
  // The very tip has a normal, too.
  const Surface<double> tip =
      quadric_surface(built.triangles->quadric(0), Vec3<double>(0.0, 0.0, 1.0), Vec3<double>(0.0, 0.0, -1.0));
  EXPECT_EQ(tip.geometric.z, 1.0);
}

// A glass ball turns a ray by twice the difference of Snell's angles.
TEST(QuadricSurface, AGlassBallRefractsByClosedForm) {
  const test::Built built(scene_of({{.kind = QuadricKind::sphere, .base = {0.0, 0.0, 0.0}, .radius = 1.0}}));
  constexpr double index = 1.5;
  for (const double height : {0.0, 0.1, 0.5, 0.9, 0.99}) {
    accel::Ray ray{{height, 0.0, 5.0}, {0.0, 0.0, -1.0}};
    for (const double ratio : {1.0 / index, index}) {
      const accel::Hit hit = built.structure->closest(ray);
      ASSERT_TRUE(hit.found());
      const Surface<double> surface = surface_of(built, ray, hit);
      EXPECT_EQ(surface.outside, ratio < 1.0);
      Vec3<double> direction;
      ASSERT_TRUE(refracted(surface, Vec3<double>(ray.direction), ratio, direction));
      ray = leaving(surface, plain(direction));
    }
    EXPECT_FALSE(built.structure->occluded(ray));
    const double turn = 2.0 * (std::asin(height) - std::asin(height / index));
    EXPECT_NEAR(ray.direction.x, -std::sin(turn), 1e-12);
    EXPECT_NEAR(ray.direction.z, -std::cos(turn), 1e-12);
  }
}

// A sphere of no power is not seen at all.
TEST(QuadricSurface, AClearBallIsInvisible) {
  scenes::Scene scene = scene_of({{.kind = QuadricKind::sphere, .base = {0.3, 0.0, 0.0}, .radius = 2.0},
                                  {.kind = QuadricKind::sphere, .base = {-1.0, 0.0, 5.0}, .radius = 1.0}});
  scene.materials[0].diffuse = 0.0;
  scene.materials[0].transmission = 1.0;
  scene.background = {0.25, 0.5, 0.75};
  const Frame frame = test::Built(scene, "octree").render({.width = 64, .height = 64, .max_depth = 8});
  EXPECT_GT(frame.rays.traced[3], 500U);
  for (const glm::vec3& pixel : frame.image.pixels) {
    ASSERT_EQ(pixel, glm::vec3(0.25F, 0.5F, 0.75F));
  }
}

// No light reaches the far half of a ball, all of it the near half.
TEST(QuadricSurface, ABallIsLitOnOneSide) {
  scenes::Scene scene = scene_of({{.kind = QuadricKind::sphere, .base = {0.0, 0.0, 0.0}, .radius = 2.0}});
  scene.lights.emplace_back();
  scene.lights[0].kind = scenes::LightKind::directional;
  scene.lights[0].direction = {-1.0, 0.0, 0.0};
  const Frame frame = test::Built(scene, "octree").render({.width = 64, .height = 64, .max_depth = 1});
  EXPECT_GT(frame.rays.traced[1], 300U);
  EXPECT_EQ(frame.rays.hit[1], 0U) << "a lit point of a ball alone is in nobody's shadow";
  for (std::uint32_t x = 0; x < 64; ++x) {
    const double lit = frame.image.at(x, 32).r;
    const bool on_ball = frame.image.at(x, 32).r != 0.0F;
    if (x < 31) {
      EXPECT_EQ(lit, 0.0) << x;
    } else if (on_ball) {
      EXPECT_GT(lit, 0.0) << x;
    }
  }
}

}  // namespace
}  // namespace marti::processors
