// Colours with a closed form, and the laws of optics.
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "processors/program/log_rules.h"
#include "processors/program/power.h"
#include "processors/program/shading.h"
#include "program_scenes.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

void expect_color(const glm::vec3& got, const glm::dvec3& want) {
  EXPECT_NEAR(got.x, want.x, 1e-6);
  EXPECT_NEAR(got.y, want.y, 1e-6);
  EXPECT_NEAR(got.z, want.z, 1e-6);
}

scenes::Material matt(const glm::dvec3& color, double diffuse = 1.0) {
  scenes::Material material;
  material.color = color;
  material.diffuse = diffuse;
  return material;
}

/// Sends `reflection` and `transmission` on, and adds `emission` itself.
scenes::Material glass(double reflection, double transmission, double ior, const glm::dvec3& emission = {}) {
  scenes::Material material = matt({0.0, 0.0, 0.0}, 0.0);
  material.reflection = reflection;
  material.transmission = transmission;
  material.ior = ior;
  material.emission = emission;
  return material;
}

scenes::Light lamp(const glm::dvec3& position, const glm::dvec3& color = {1.0, 1.0, 1.0}) {
  scenes::Light light;
  light.position = position;
  light.color = color;
  return light;
}

/// The colour of the origin of a matt floor under one light, without shadows.
glm::vec3 floor_under(const scenes::Light& light, const scenes::Material& material) {
  scenes::Scene scene = test::looking_down(10.0);
  scene.materials.push_back(material);
  scene.lights.push_back(light);
  test::add_floor(scene, 0.0, 20.0, 0);
  RenderOptions options = test::one_pixel();
  options.shadows = false;
  return Built(scene).render(options).image.at(0, 0);
}

TEST(Shading, LambertAmbientAndEmission) {
  scenes::Scene scene = test::looking_down(10.0);
  scene.ambient = {0.1, 0.2, 0.3};
  scene.materials.push_back(matt({0.5, 0.25, 1.0}, 0.9));
  scene.materials[0].emission = {0.01, 0.02, 0.03};
  scene.lights.push_back(lamp({3.0, 0.0, 4.0}, {2.0, 1.0, 0.5}));  // cosine 4/5
  test::add_floor(scene, 0.0, 20.0, 0);
  const Frame frame = Built(scene).render(test::one_pixel());
  expect_color(frame.image.at(0, 0),
               {0.01 + 0.5 * 0.9 * (0.1 + 0.8 * 2.0), 0.02 + 0.25 * 0.9 * (0.2 + 0.8 * 1.0),
                0.03 + 1.0 * 0.9 * (0.3 + 0.8 * 0.5)});
  EXPECT_EQ(frame.rays.traced, (std::array<std::uint64_t, ray_kinds>{1, 1, 0, 0}));
  EXPECT_EQ(frame.rays.hit, (std::array<std::uint64_t, ray_kinds>{1, 0, 0, 0}));
}

RC_GTEST_PROP(Shading, PointLightsFollowTheCosineAndTheirFallOff, ()) {
  const auto unit = [] { return *rc::gen::inRange(-1000, 1001) / 100.0; };
  const glm::dvec3 position(unit(), unit(), unit());
  const double squared = glm::dot(position, position);
  RC_PRE(squared > 0.01);
  scenes::Light light = lamp(position);
  light.inverse_square = *rc::gen::arbitrary<bool>();
  light.range = *rc::gen::element(0.0, 5.0, 12.0);
  double strength = light.inverse_square ? 1.0 / squared : 1.0;
  if (light.range > 0.0) {
    strength *= std::max(0.0, 1.0 - std::pow(std::sqrt(squared) / light.range, 4.0));
  }
  const double want = std::max(0.0, position.z / std::sqrt(squared)) * strength;
  const double got = floor_under(light, matt({1.0, 1.0, 1.0})).x;
  RC_ASSERT(std::abs(got - want) <= 1e-6 * std::max(1.0, want));
}

TEST(Shading, DirectionalAndSpotLights) {
  scenes::Light light = lamp({0.0, 0.0, 2.0});
  light.kind = scenes::LightKind::directional;
  light.direction = glm::normalize(glm::dvec3(1.0, 0.0, -1.0));
  EXPECT_NEAR(floor_under(light, matt({1.0, 1.0, 1.0})).x, std::sqrt(0.5), 1e-6);

  light.kind = scenes::LightKind::spot;
  light.cos_inner_cone = 0.9;
  light.cos_outer_cone = 0.5;
  light.direction = {0.0, 0.0, -1.0};  // in the inner cone
  EXPECT_NEAR(floor_under(light, matt({1.0, 1.0, 1.0})).x, 1.0, 1e-6);
  light.direction = {0.6, 0.0, -0.8};  // between: ((0.8 - 0.5) / 0.4)^2
  EXPECT_NEAR(floor_under(light, matt({1.0, 1.0, 1.0})).x, 0.5625, 1e-6);
  light.direction = {1.0, 0.0, 0.0};  // outside
  EXPECT_EQ(floor_under(light, matt({1.0, 1.0, 1.0})).x, 0.0F);
}

TEST(Shading, HighlightOfTheHalfwayVector) {
  scenes::Material shiny = matt({0.0, 0.0, 0.0}, 0.0);
  shiny.highlight = 0.5;
  shiny.shininess = 20.0;
  shiny.specular_color = {1.0, 0.5, 0.25};
  // Viewer along +z, light at angle a: the halfway vector is at a / 2.
  const double a = 0.6;
  const double want = 0.5 * std::pow(std::cos(a / 2), 20.0);
  expect_color(floor_under(lamp({5.0 * std::sin(a), 0.0, 5.0 * std::cos(a)}), shiny),
               {want, want / 2, want / 4});
}

RC_GTEST_PROP(Shading, PowerIsPower, ()) {
  const double base = *rc::gen::inRange(0, 1000001) / 1e6;
  const double exponent = *rc::gen::element(0.0, 0.5, 1.0, 3.0827, 101.2, 1000.0, 100000.0);
  const double want = std::pow(base, exponent);
  const double got = power(base, exponent);
  // Very small powers lose in proportion to their logarithm.
  const double tolerance = want < 1e-290 ? 1e-290 : want * 1e-12 * std::max(1.0, -std::log(want) / 69.0);
  RC_ASSERT(std::abs(got - want) <= tolerance);
}

TEST(Shading, MirrorShowsTheBackgroundTinted) {
  scenes::Scene scene = test::looking_down(10.0);
  scene.background = {0.2, 0.4, 0.6};
  scene.materials.push_back(glass(0.75, 0.0, 1.0));
  scene.materials[0].specular_color = {1.0, 0.5, 0.25};
  test::add_floor(scene, 0.0, 20.0, 0);
  const Frame frame = Built(scene).render(test::one_pixel(2));
  expect_color(frame.image.at(0, 0), {0.15, 0.15, 0.1125});
  EXPECT_EQ(frame.rays.traced, (std::array<std::uint64_t, ray_kinds>{1, 0, 1, 0}));
}

TEST(Shading, ParallelMirrorsAddAGeometricSeriesUpToTheDepthLimit) {
  scenes::Scene scene = test::looking_down(1.0);
  scene.background = {9.0, 9.0, 9.0};
  scene.materials.push_back(glass(0.5, 0.0, 1.0, {0.125, 0.25, 0.5}));
  test::add_floor(scene, 0.0, 20.0, 0);
  test::add_ceiling(scene, 2.0, 20.0, 0);
  const Built built(scene);
  for (std::uint32_t depth = 1; depth <= max_ray_depth; ++depth) {
    const Frame frame = built.render(test::one_pixel(depth));
    const double sum = 2.0 - std::pow(0.5, depth - 1.0);
    expect_color(frame.image.at(0, 0), glm::dvec3(0.125, 0.25, 0.5) * sum);
    EXPECT_EQ(frame.rays.all(), depth);
  }
}

TEST(Shading, RaysBelowTheLeastWeightAreNotTraced) {
  scenes::Scene scene = test::looking_down(1.0);
  scene.materials.push_back(glass(0.5, 0.0, 1.0));
  test::add_floor(scene, 0.0, 20.0, 0);
  test::add_ceiling(scene, 2.0, 20.0, 0);
  RenderOptions options = test::one_pixel(20);
  options.min_weight = 0.1;  // 1, 1/2, 1/4, 1/8 are traced, 1/16 is not
  EXPECT_EQ(Built(scene).render(options).rays.all(), 4U);
  options.min_weight = 0.125;
  EXPECT_EQ(Built(scene).render(options).rays.all(), 4U);
}

TEST(Shading, ASlabOfIndexOneIsInvisible) {
  scenes::Scene scene = test::looking_down(4.0);
  scene.background = {0.1, 0.2, 0.3};
  scene.materials.push_back(glass(0.0, 1.0, 1.0));
  scene.materials.push_back(matt({0.9, 0.5, 0.1}));
  scene.lights.push_back(lamp({0.5, 0.0, -1.5}));  // under the slab: its shadow rays stay below
  test::add_floor(scene, -2.0, 1.0, 1);
  const RenderOptions options{.width = 40, .height = 40, .max_depth = 3};
  const Frame without = Built(scene).render(options);
  test::add_floor(scene, 0.0, 20.0, 0);
  test::add_ceiling(scene, -1.0, 20.0, 0);
  const Frame with = Built(scene).render(options);
  EXPECT_EQ(with.rays.traced[3], 2U * 1600);
  for (std::size_t i = 0; i < 1600; ++i) {
    expect_color(with.image.pixels[i], without.image.pixels[i]);
  }
}

TEST(Shading, TotalInternalReflectionCarriesAllTheWeight) {
  scenes::Scene scene;
  scene.camera.eye = {0.0, 0.0, -1.0};
  scene.camera.up = {0.0, 1.0, 0.0};
  scene.background = {1.0, 1.0, 1.0};
  scene.materials.push_back(glass(0.25, 0.5, 1.5));
  test::add_floor(scene, 0.0, 100.0, 0);
  scene.camera.at = {3.0, 0.0, 0.0};  // 71.6 degrees; the critical angle is 41.8
  Frame frame = Built(scene).render(test::one_pixel(2));
  expect_color(frame.image.at(0, 0), {0.75, 0.75, 0.75});
  EXPECT_EQ(frame.rays.traced, (std::array<std::uint64_t, ray_kinds>{1, 0, 1, 0}));
  scene.camera.at = {0.5, 0.0, 0.0};  // 26.6 degrees
  frame = Built(scene).render(test::one_pixel(2));
  expect_color(frame.image.at(0, 0), {0.75, 0.75, 0.75});
  EXPECT_EQ(frame.rays.traced, (std::array<std::uint64_t, ray_kinds>{1, 0, 1, 1}));
}

RC_GTEST_PROP(Shading, RefractionObeysSnell, ()) {
  const auto part = [] { return *rc::gen::inRange(-1000, 1001) / 1000.0; };
  const glm::dvec3 n(part(), part(), part());
  glm::dvec3 d(part(), part(), part());
  RC_PRE(glm::length(n) > 0.01 && glm::length(d) > 0.01);
  Surface<double> surface;
  surface.normal = surface.geometric = Vec3<double>(glm::normalize(n));
  Vec3<double> direction(glm::normalize(d));
  if (dot(direction, surface.normal) > 0.0) {
    direction = -direction;
  }
  RC_PRE(dot(direction, surface.normal) < -1e-6);
  const double ratio = *rc::gen::inRange(400, 2500) / 1000.0;
  const auto sine = [&](const Vec3<double>& v) {
    const Vec3<double> c = cross(v, surface.normal);
    return std::sqrt(dot(c, c));
  };
  Vec3<double> out;
  if (refracted(surface, direction, ratio, out)) {
    RC_ASSERT(std::abs(dot(out, out) - 1.0) < 1e-12);
    RC_ASSERT(std::abs(sine(out) - ratio * sine(direction)) < 1e-9);
    RC_ASSERT(std::abs(dot(out, cross(direction, surface.normal))) < 1e-12);
    RC_ASSERT(dot(out, surface.normal) <= 0.0);
  } else {
    RC_ASSERT(ratio * sine(direction) > 1.0 - 1e-12);
  }
  const Vec3<double> mirror = reflected(surface, direction);
  RC_ASSERT(std::abs(dot(mirror, mirror) - 1.0) < 1e-12);
  RC_ASSERT(std::abs(dot(mirror, surface.normal) + dot(direction, surface.normal)) < 1e-12);
}

TEST(Shading, OpaqueShadowsCanBeSwitchedOff) {
  scenes::Scene scene = test::looking_down(1.0);
  scene.materials.push_back(matt({1.0, 1.0, 1.0}));
  scene.materials.push_back(glass(0.0, 1.0, 1.0));
  scene.lights.push_back(lamp({0.0, 0.0, 8.0}));
  test::add_floor(scene, 0.0, 20.0, 0);
  test::add_floor(scene, 4.0, 1.0, 1);  // behind the camera, between floor and lamp; even glass blocks
  Frame frame = Built(scene).render(test::one_pixel());
  EXPECT_EQ(frame.image.at(0, 0).x, 0.0F);
  EXPECT_EQ(frame.rays.hit[1], 1U);
  RenderOptions options = test::one_pixel();
  options.shadows = false;
  frame = Built(scene).render(options);
  EXPECT_NEAR(frame.image.at(0, 0).x, 1.0, 1e-6);
  EXPECT_EQ(frame.rays.traced[1], 0U);
  scene.lights[0].position.z = 3.0;  // now the blocker lies beyond the lamp
  EXPECT_NEAR(Built(scene).render(test::one_pixel()).image.at(0, 0).x, 1.0, 1e-6);
}

TEST(Shading, LightsThatCannotMatterGetNoShadowRay) {
  scenes::Scene scene = test::looking_down(5.0);
  scene.materials.push_back(matt({1.0, 1.0, 1.0}));
  test::add_floor(scene, 0.0, 20.0, 0);
  scene.lights.push_back(lamp({0.0, 0.0, -8.0}));                  // behind the surface
  scene.lights.push_back(lamp({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}));  // dark
  scene.lights.push_back(lamp({0.0, 0.0, 8.0}));
  scene.lights.back().range = 2.0;  // out of range
  EXPECT_EQ(Built(scene).render(test::one_pixel()).rays.traced[1], 0U);
  scene.lights.push_back(lamp({0.0, 0.0, 8.0}));
  EXPECT_EQ(Built(scene).render(test::one_pixel()).rays.traced[1], 1U);
}

TEST(Shading, TheTexelUnderThePointColoursItAndIsLogged) {
  scenes::Scene scene = test::looking_down(10.0);
  scene.materials.push_back(matt({0.5, 1.0, 1.0}));
  scene.materials[0].texture = 0;
  scene.ambient = {1.0, 1.0, 1.0};
  test::add_floor(scene, 0.0, 1.0, 0);
  scene.uvs = {{0.0, 1.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 0.0}};
  scenes::Texture texture;
  texture.width = 2;
  texture.height = 1;
  texture.srgb = false;
  texture.texels = {{255, 0, 0, 255}, {0, 255, 51, 255}};
  scene.textures.push_back(texture);
  scene.camera.vertical_fov = 2.0 * std::atan(0.1);  // the floor fills the view
  const Frame frame = Built(scene).render({.width = 2, .height = 2, .max_depth = 1, .record = true});
  for (std::uint32_t y = 0; y < 2; ++y) {
    expect_color(frame.image.at(0, y), {0.5, 0.0, 0.0});
    expect_color(frame.image.at(1, y), {0.0, 1.0, 0.2});
    for (std::uint32_t x = 0; x < 2; ++x) {
      const auto words = frame.log->pixel(x, y);
      ASSERT_GE(words.size(), 2U);
      EXPECT_EQ(words[words.size() - 2], make_word(Step::texel, 0));
      EXPECT_EQ(words.back(), x);
    }
  }
  EXPECT_EQ(program::fault_of(*frame.log), "");
}

}  // namespace
}  // namespace marti::processors
