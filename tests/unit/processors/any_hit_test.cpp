// Frames of rays that any hit ends, against closed forms: what a hemisphere sees of balls and planes, what a
// half-covered panel gives. That all structures agree with brute force is tested with all other frames
// (program_render_test.cpp).
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "program_scenes.h"
#include "scenes/procedural.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

constexpr auto shadow_ray = static_cast<std::size_t>(RayKind::shadow);

/// Looks from `height` at a small spot of a floor about the origin.
scenes::Scene spot_of_a_floor(double height, double half = 50.0) {
  scenes::Scene scene = test::looking_down(height);
  scene.camera.vertical_fov = 0.002;
  scene.materials.resize(2);
  scene.materials[1].emission = glm::dvec3(3.0);
  test::add_floor(scene, 0.0, half, 0);
  return scene;
}

scenes::Quadric ball_at(const glm::dvec3& center, double radius) {
  scenes::Quadric quadric;
  quadric.base = center;
  quadric.radius = radius;
  return quadric;
}

RenderOptions any_hit(Integrator integrator, std::uint32_t rays, double distance = 0.0) {
  RenderOptions options{.width = 8, .height = 8, .max_depth = 1, .integrator = integrator};
  options.secondary_rays = rays;
  options.occlusion_distance = distance;
  return options;
}

double mean_share(const Frame& frame) {
  double sum = 0.0;
  for (const glm::vec3& pixel : frame.image.pixels) {
    EXPECT_EQ(pixel.x, pixel.y);
    sum += static_cast<double>(pixel.x);
  }
  return sum / static_cast<double>(frame.image.pixels.size());
}

/// Four standard deviations of the mean of so many independent yes or no.
double four_sigma(const Frame& frame, double chance) {
  return 4.0 * std::sqrt(chance * (1.0 - chance) / static_cast<double>(frame.rays.traced[shadow_ray]));
}

// Inside a closed ball, and inside a closed room of triangles, all is occluded; over a plane nothing is.
TEST(AnyHit, InsideAllIsOccludedAndOverAPlaneNothing) {
  scenes::Scene inside = test::looking_down(0.5);
  inside.materials.resize(1);
  inside.quadrics.push_back(ball_at(glm::dvec3(0.0), 1.0));
  scenes::Scene room = scenes::make_procedural("room:2");
  for (const scenes::Scene& scene : {inside, room}) {
    const Frame frame = Built(scene).render(any_hit(Integrator::occlusion, 16));
    EXPECT_EQ(frame.rays.traced[shadow_ray], 8U * 8U * 16U);
    EXPECT_EQ(frame.rays.hit[shadow_ray], frame.rays.traced[shadow_ray]);
    EXPECT_EQ(mean_share(frame), 0.0);
  }
  const Frame plane = Built(spot_of_a_floor(3.0)).render(any_hit(Integrator::occlusion, 16));
  EXPECT_EQ(plane.rays.traced[shadow_ray], 8U * 8U * 16U);
  EXPECT_EQ(mean_share(plane), 1.0);
}

// A ball of radius r, whose centre is d above the point, takes (r/d)^2 of the cosine-weighted hemisphere
// (Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-38), a wall without end that
// stands at the point a half. Rays that end before it see none of it.
TEST(AnyHit, OcclusionIsTheShareOfTheHemisphere) {
  scenes::Scene below = spot_of_a_floor(0.1);
  below.quadrics.push_back(ball_at({0.0, 0.0, 2.0}, std::numbers::sqrt2));
  const Frame half = Built(below).render(any_hit(Integrator::occlusion, 256));
  EXPECT_NEAR(mean_share(half), 0.5, four_sigma(half, 0.5));
  below.quadrics[0].radius = 0.4;
  const Frame small = Built(below).render(any_hit(Integrator::occlusion, 256));
  EXPECT_NEAR(mean_share(small), 1.0 - 0.04, four_sigma(small, 0.04));

  // The scene's largest side is that of its floor: 100.
  const Frame shorter = Built(below).render(any_hit(Integrator::occlusion, 64, 0.0159));
  EXPECT_EQ(mean_share(shorter), 1.0);
  const Frame longer = Built(below).render(any_hit(Integrator::occlusion, 256, 0.0161));
  EXPECT_LT(mean_share(longer), 1.0);

  scenes::Scene walled = spot_of_a_floor(3.0, 1e4);
  // Beside the spot, which is 0.006 wide.
  test::add_quad(walled, {0.004, -1e4, 0.0}, {0.004, -1e4, 1e4}, {0.004, 1e4, 1e4}, {0.004, 1e4, 0.0}, 0);
  const Frame wall = Built(walled).render(any_hit(Integrator::occlusion, 256));
  EXPECT_NEAR(mean_share(wall), 0.5, four_sigma(wall, 0.5) + 1e-4);
}

// A panel far above the middle of a screen that covers one half of it from a point gives that point half of
// its rays; without the screen all. A panel that faces away, and a point behind its surface, get none.
TEST(AnyHit, HalfOfAPanelIsSeenBesideAScreen) {
  scenes::Scene open = spot_of_a_floor(0.5);
  test::add_ceiling(open, 4.0, 0.5, 1);
  const Frame all = Built(open).render(any_hit(Integrator::shadow, 64));
  EXPECT_EQ(all.rays.traced[shadow_ray], 8U * 8U * 64U);
  EXPECT_EQ(mean_share(all), 1.0);
  EXPECT_EQ(all.rays.hit[shadow_ray], 0U);
  scenes::Scene screened = open;
  test::add_quad(screened, {0.0, -5.0, 2.0}, {5.0, -5.0, 2.0}, {5.0, 5.0, 2.0}, {0.0, 5.0, 2.0}, 0);
  const Frame half = Built(screened).render(any_hit(Integrator::shadow, 256));
  // The spot's own width moves the screen's edge on the panel by a thousandth of it.
  EXPECT_NEAR(mean_share(half), 0.5, four_sigma(half, 0.5) + 1e-3);
}

// Rays to a point light and to a sun spread as the disc of their balls does: a ball just as wide before the
// light blocks all of them, one of 0.7 times its radius as much as a sphere's own points project behind it.
TEST(AnyHit, LightsWithoutExtentAreSmallBalls) {
  for (const scenes::LightKind kind : {scenes::LightKind::point, scenes::LightKind::directional}) {
    scenes::Scene scene = spot_of_a_floor(0.5);
    scenes::Light light;
    light.kind = kind;
    light.position = {0.0, 0.0, 64.0};
    scene.lights = {light};
    const Frame lit = Built(scene).render(any_hit(Integrator::shadow, 64));
    EXPECT_EQ(mean_share(lit), 1.0);
    EXPECT_EQ(lit.rays.traced[shadow_ray], 8U * 8U * 64U);
    const auto behind_a_ball = [&](double part) {
      scenes::Scene covered = scene;
      covered.quadrics.push_back(ball_at({0.0, 0.0, 32.0}, 0.5 * part));
      return Built(covered).render(any_hit(Integrator::shadow, 256));
    };
    EXPECT_EQ(mean_share(behind_a_ball(1.02)), 0.0);
    const Frame some = behind_a_ball(0.7);
    // Of points of a sphere, as many lie within a share s of its radius from an axis as 1 - sqrt(1 - s^2).
    EXPECT_NEAR(mean_share(some), std::sqrt(1.0 - 0.49), four_sigma(some, 0.3) + 0.02);
  }
}

// Of several lights each has its share of the rays, whichever comes first.
TEST(AnyHit, LightsTakeTurns) {
  scenes::Scene scene = spot_of_a_floor(0.5);
  scenes::Light light;
  light.kind = scenes::LightKind::directional;
  scene.lights = {light, light, light};
  scene.lights[1].direction = {0.0, 0.0, 1.0};  // from below
  test::add_ceiling(scene, 4.0, 0.5, 1);
  const Frame frame = Built(scene).render(any_hit(Integrator::shadow, 4));
  EXPECT_EQ(frame.rays.traced[shadow_ray], 8U * 8U * 3U);
  scene.lights.clear();
  scene.materials[1].emission = glm::dvec3(0.0);
  const Frame dark = Built(scene).render(any_hit(Integrator::shadow, 4));
  EXPECT_EQ(dark.rays.traced[shadow_ray], 0U);
  EXPECT_EQ(mean_share(dark), 0.0);
}

}  // namespace
}  // namespace marti::processors
