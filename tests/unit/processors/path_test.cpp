// Path tracing against closed forms: furnaces, boxes, direct light; how its error falls; that its image
// depends on pixel, sample and seed alone.
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "processors/program/path_sampling.h"
#include "processors/program/pixel_set.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

RenderOptions paths(std::uint32_t side, std::uint32_t samples, std::uint32_t max_depth) {
  RenderOptions options{.width = side, .height = side, .max_depth = max_depth};
  options.integrator = Integrator::path;
  options.samples = samples;
  return options;
}

scenes::Material matt(const glm::dvec3& color, const glm::dvec3& emission = glm::dvec3(0.0)) {
  scenes::Material material;
  material.color = color;
  material.emission = emission;
  return material;
}

scenes::Quadric ball(const glm::dvec3& center, double radius, std::uint32_t material) {
  scenes::Quadric quadric;
  quadric.base = center;
  quadric.radius = radius;
  quadric.material = material;
  return quadric;
}

/// Looks from `height` at a small spot of the floor around the origin.
scenes::Scene looking_at_a_spot(double height) {
  scenes::Scene scene = test::looking_down(height);
  scene.camera.vertical_fov = 0.002;
  return scene;
}

glm::dvec3 mean_of(const Image& image) {
  glm::dvec3 sum(0.0);
  for (const glm::vec3& pixel : image.pixels) {
    sum += glm::dvec3(pixel);
  }
  return sum / static_cast<double>(image.pixels.size());
}

void expect_near(const glm::dvec3& got, const glm::dvec3& want, double relative) {
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(got[channel], want[channel], relative * want[channel]) << channel;
  }
}

// Light from everywhere is scattered once by a ball: each sample has the colour of the ball times the light.
TEST(Path, ABallInAFurnaceHasItsOwnColour) {
  scenes::Scene scene = test::looking_down(5.0);
  scene.background = {1.0, 2.0, 3.0};
  scene.materials.push_back(matt({0.7, 0.5, 0.3}));
  scene.quadrics.push_back(ball({0.0, 0.0, 0.0}, 1.0, 0));
  scene.camera.vertical_fov = 0.3;
  const Image image = Built(scene).render(paths(8, 3, 4)).image;
  for (const glm::vec3& pixel : image.pixels) {
    expect_near(pixel, {0.7, 1.0, 0.9}, 1e-5);
  }
}

/// The inside of a ball that emits 1 and scatters `albedo`, seen from its centre.
Image inside_a_ball(double albedo, const RenderOptions& options) {
  scenes::Scene scene = test::looking_down(0.0);
  scene.camera.at = {1.0, 0.0, 0.0};
  scene.camera.up = {0.0, 0.0, 1.0};
  scene.materials.push_back(matt(glm::dvec3(albedo), glm::dvec3(1.0)));
  scene.quadrics.push_back(ball({0.0, 0.0, 0.0}, 2.0, 0));
  return Built(scene).render(options).image;
}

// The geometric series 1 + a + a^2 + ..., one term for each ray; balls are no emitters that points are drawn
// of.
TEST(Path, InsideAWhiteBallLightAddsUpToTheGeometricSeries) {
  for (std::uint32_t depth = 1; depth <= 3; ++depth) {  // without chance
    double series = 0.0;
    for (std::uint32_t ray = 0; ray < depth; ++ray) {
      series += std::pow(0.6, ray);
    }
    expect_near(mean_of(inside_a_ball(0.6, paths(4, 1, depth))), glm::dvec3(series), 1e-6);
  }
  // Paths of up to 40 rays that end by chance: the mean is the same, within 1 %.
  expect_near(mean_of(inside_a_ball(0.8, paths(32, 64, 40))), glm::dvec3((1.0 - std::pow(0.8, 40)) / 0.2),
              0.01);
}

// A box whose walls emit 1 and scatter a: points of emissive triangles are asked for, so a path of n rays has
// one term more than rays.
TEST(Path, InsideAWhiteBoxAskingForLightAddsOneTermMore) {
  scenes::Scene scene = looking_at_a_spot(0.5);
  scene.materials.push_back(matt(glm::dvec3(0.5), glm::dvec3(1.0)));
  test::add_floor(scene, 0.0, 1.0, 0);
  test::add_ceiling(scene, 2.0, 1.0, 0);
  test::add_quad(scene, {-1, -1, 0}, {-1, -1, 2}, {1, -1, 2}, {1, -1, 0}, 0);
  test::add_quad(scene, {-1, 1, 0}, {1, 1, 0}, {1, 1, 2}, {-1, 1, 2}, 0);
  test::add_quad(scene, {-1, -1, 0}, {-1, 1, 0}, {-1, 1, 2}, {-1, -1, 2}, 0);
  test::add_quad(scene, {1, -1, 0}, {1, -1, 2}, {1, 1, 2}, {1, 1, 0}, 0);
  for (std::uint32_t depth = 1; depth <= 6; ++depth) {
    const double series = (1.0 - std::pow(0.5, depth + 1)) / 0.5;
    expect_near(mean_of(Built(scene).render(paths(16, 256, depth)).image), glm::dvec3(series), 0.02);
  }
}

// The form factor of a square from a point below its middle: four times that of a quarter (Howell, "A catalog
// of radiation heat transfer configuration factors", B-3).
TEST(Path, DirectLightOfASquareIsItsFormFactor) {
  for (const double half : {0.25, 1.0, 4.0}) {
    scenes::Scene scene = looking_at_a_spot(0.5);
    scene.materials.push_back(matt({0.9, 0.6, 0.3}));
    scene.materials.push_back(matt(glm::dvec3(0.0), glm::dvec3(2.0)));
    test::add_floor(scene, 0.0, 10.0, 0);
    test::add_ceiling(scene, 1.0, half, 1);
    const double side = half / std::sqrt(1.0 + half * half);
    const double quarter = side * std::atan(side) / std::numbers::pi;
    expect_near(mean_of(Built(scene).render(paths(16, 1024, 1)).image),
                glm::dvec3(0.9, 0.6, 0.3) * (2.0 * 4.0 * quarter), 0.01);
  }
}

// A ball is met by chance only; it lights the point below it by the square of the sine under which it is
// seen.
TEST(Path, LightOfABallIsMetByChance) {
  scenes::Scene scene = looking_at_a_spot(0.5);
  scene.materials.push_back(matt(glm::dvec3(0.5)));
  scene.materials.push_back(matt(glm::dvec3(0.0), glm::dvec3(3.0)));
  test::add_floor(scene, 0.0, 10.0, 0);
  scene.quadrics.push_back(ball({0.0, 0.0, 2.0}, 1.0, 1));
  expect_near(mean_of(Built(scene).render(paths(16, 256, 2)).image), glm::dvec3(0.5 * 3.0 * 0.25), 0.02);
}

TEST(Path, EmissionIsSeenInMirrors) {
  scenes::Scene scene = looking_at_a_spot(0.5);
  scenes::Material mirror = matt(glm::dvec3(0.0));
  mirror.reflection = 0.75;
  scene.materials.push_back(mirror);
  scene.materials.push_back(matt(glm::dvec3(0.0), {1.0, 2.0, 4.0}));
  test::add_floor(scene, 0.0, 10.0, 0);
  test::add_ceiling(scene, 1.0, 1.0, 1);
  const Frame frame = Built(scene).render(paths(2, 2, 2));
  expect_near(mean_of(frame.image), glm::dvec3(0.75, 1.5, 3.0), 1e-6);
  EXPECT_EQ(frame.rays.traced[static_cast<std::size_t>(RayKind::shadow)], 0U) << "nothing scatters";
}

// A light without area adds what it adds without paths.
TEST(Path, PointLightsShineAsInWhittedsProgram) {
  scenes::Scene scene = looking_at_a_spot(0.5);
  scene.materials.push_back(matt({0.9, 0.6, 0.3}));
  scene.materials[0].highlight = 0.5;
  scenes::Light& light = scene.lights.emplace_back();
  light.position = {1.0, 1.0, 3.0};
  test::add_floor(scene, 0.0, 10.0, 0);
  RenderOptions whitted = paths(2, 2, 1);
  whitted.integrator = Integrator::whitted;
  const Built built(scene);
  EXPECT_TRUE(test::same_bytes(built.render(whitted).image, built.render(paths(2, 2, 1)).image));
}

double rms_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::dvec3 difference = glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]);
    sum += glm::dot(difference, difference);
  }
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

// 16 times the samples: a quarter of the error. Images of two seeds differ by sqrt(2) errors. The room is
// seen without its panel, whose bright straight edges the jittered camera rays resolve faster than that, and
// with two rays a path: with three, the few paths that go from a wall over the mirrored ball to the panel
// bring so much light that 64 samples do not show their mean.
TEST(Path, TheErrorFallsWithTheSquareRootOfTheSamples) {
  for (const auto& [name, depth] :
       {std::pair("room:2", 2U), std::pair("teapot:3", 5U), std::pair("gears:1", 5U)}) {
    scenes::Scene scene = scenes::make_procedural(name);
    if (scene.lights.empty()) {
      scene.camera.at = {0.0, 0.0, 1.0};
      scene.camera.vertical_fov = 0.5;
    }
    const Built built(scene, "octree");
    const auto error = [&, max_depth = depth](std::uint32_t samples) {
      RenderOptions options = paths(24, samples, max_depth);
      const Image one = built.render(options).image;
      options.seed = 2;
      return rms_difference(one, built.render(options).image);
    };
    const double ratio = error(4) / error(64);
    EXPECT_GT(ratio, 3.5) << name;
    EXPECT_LT(ratio, 4.6) << name;
  }
}

TEST(Path, RefusesWhatWouldBeWrong) {
  const Built built(scenes::make_procedural("room:2"), "octree");
  RenderOptions options = paths(4, 1, 2);
  options.min_weight = 0.1;
  EXPECT_THROW(static_cast<void>(built.render(options)), sim::UserError);
  options.min_weight = 0.0;
  options.voxel_cut = 1.0;
  EXPECT_THROW(static_cast<void>(built.render(options)), sim::UserError);
}

TEST(Emitters, AreDrawnByAreaAndStrength) {
  scenes::Scene scene;
  scene.materials = {matt(glm::dvec3(0.5)), matt(glm::dvec3(0.5), glm::dvec3(1.0)),
                     matt(glm::dvec3(0.5), glm::dvec3(3.0))};
  test::add_floor(scene, 0.0, 1.0, 0);  // emits nothing
  test::add_floor(scene, 1.0, 1.0, 1);  // two triangles of area 2
  test::add_floor(scene, 2.0, 2.0, 2);  // two of area 8 and thrice the light
  const Emitters emitters(scene);
  EXPECT_FALSE(emitters.has(0));
  EXPECT_TRUE(emitters.has(2));
  EXPECT_TRUE(emitters.has(5));
  EXPECT_FALSE(emitters.has(6));
  constexpr int draws = 5200;
  std::array<int, 6> drawn{};
  for (int i = 0; i < draws; ++i) {
    const Emitters::Choice choice = emitters.choose((i + 0.5) / draws);
    ++drawn.at(choice.triangle);
    EXPECT_DOUBLE_EQ(choice.area_over_chance, choice.triangle < 4 ? 2.0 * 26.0 : 8.0 * 26.0 / 12.0);
  }
  EXPECT_EQ(drawn, (std::array<int, 6>{0, 0, 200, 200, 2400, 2400}));
  EXPECT_EQ(emitters.choose(0.0).triangle, 2U);
  EXPECT_EQ(emitters.choose(std::nextafter(1.0, 0.0)).triangle, 5U);
  EXPECT_TRUE(Emitters(scenes::make_procedural("teapot:2")).empty());
}

TEST(Emitters, OneWithoutAreaOrTooLargeIsNotDrawn) {
  scenes::Scene scene;
  scene.materials = {matt(glm::dvec3(0.5), glm::dvec3(1.0))};
  scene.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {1e200, 0.0, 0.0}, {0.0, 1e200, 0.0}};
  scene.triangles = {{{0, 1, 2}, 0, 0}, {{0, 3, 4}, 0, 1}};
  EXPECT_TRUE(Emitters(scene).empty());
}

TEST(PathSampling, ScatteredDirectionsFollowTheCosine) {
  const Vec3<double> normal = normalized(Vec3<double>(0.3, -0.5, 0.8));
  double sum = 0.0;
  double squares = 0.0;
  constexpr std::uint32_t draws = 40000;
  for (std::uint32_t i = 0; i < draws; ++i) {
    const Vec3<double> d = scattered(normal, PathNumbers(i % 200, i / 200, 0, 1), i % 7);
    ASSERT_NEAR(dot(d, d), 1.0, 1e-14);
    const double cosine = dot(d, normal);
    ASSERT_GE(cosine, 0.0);
    sum += cosine;
    squares += cosine * cosine;
  }
  // The density 2 c of a cosine c has the mean 2/3 and the mean square 1/2; five standard errors.
  EXPECT_NEAR(sum / draws, 2.0 / 3.0, 5.0 * std::sqrt(1.0 / 18.0 / draws));
  EXPECT_NEAR(squares / draws, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / draws));
}

}  // namespace
}  // namespace marti::processors
