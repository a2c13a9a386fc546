// `marti study error`: errors against plain sums and theory, exponents against known ones, and choices
// against all others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "scenes/scene.h"
#include "studies/error/error_keys.h"
#include "studies/error/error_tables.h"
#include "studies/error/setting.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace error;

namespace {

sim::Config config_of(const std::string& text) {
  return sim::Config::from_text(error_schema(), text, "error.toml");
}

const std::string small_study =
    "scene.source = \"gears:1\"\nimage = { width = 40, height = 32, max_depth = 4, samples = 4 }\n"
    "machine.nodes = 4\nerror = { within = [0.2, 1.0], divisors = [2], side = 20, samples = [1, 4, 16], "
    "depths = [1, 2, 3], weights = [0.1, 0.5], voxel_cuts = [16.0], repeats = 2 }\n";

ErrorConfig read(const std::string& text) {
  sim::Config config = config_of(text);
  return read_error(config);
}

std::vector<Setting> measured(const ErrorConfig& config) {
  std::vector<Setting> settings;
  add_frame_ways(config, settings);
  add_image_knobs(config, settings);
  measure(settings, config.repeats, nullptr);
  return settings;
}

const std::vector<Setting>& gears() {
  static const ErrorConfig config = read(small_study);
  static const std::vector<Setting> settings = measured(config);
  return settings;
}

const Setting& named(const std::string& way, const std::string& name) {
  const auto found = std::ranges::find_if(
      gears(), [&](const Setting& setting) { return setting.way == way && setting.name == name; });
  EXPECT_NE(found, gears().end()) << way << name;
  return *found;
}

Answer grey(float value) { return {0.0, {2, 2, sim::LargeVector<glm::vec3>(4, glm::vec3(value))}, ""}; }

TEST(ErrorStudy, ErrorsAreRelative) {
  EXPECT_DOUBLE_EQ(error_of({3.0, {}, ""}, {4.0, {}, ""}), 0.25);
  EXPECT_DOUBLE_EQ(error_of({5.0, {}, ""}, {4.0, {}, ""}), 0.25);
  EXPECT_EQ(error_of(grey(0.5F), grey(0.5F)), 0.0);
  Answer other = grey(0.5F);
  other.image.pixels[2] = {0.5F, 0.75F, 0.5F};
  EXPECT_DOUBLE_EQ(error_of(other, grey(0.5F)), 0.25 / std::sqrt(12.0) / 0.5);
  EXPECT_EQ(error_of(grey(0.0F), grey(0.0F)), 0.0);
  EXPECT_TRUE(std::isinf(error_of(grey(0.1F), grey(0.0F))));
}

TEST(ErrorStudy, ExactSettingsHaveNoErrorAndAllAreTimed) {
  for (const Setting& setting : gears()) {
    const bool exact = &setting == &gears()[setting.exact];
    EXPECT_TRUE(setting.error() == 0.0 || !(exact || setting.first.note.starts_with("exact")))
        << setting.name;
    EXPECT_EQ(setting.seconds.size(), exact && setting.drawn ? 1U : 2U) << setting.name;
  }
}

// A frame as small as this is not sampled; a bound is never above what it bounds.
TEST(ErrorStudy, WaysToTheFrameTimeAreThoseOfAUser) {
  const double exact = named("exact run", "-").first.ps;
  EXPECT_EQ(named("--within", "20 %").first.ps, exact);
  EXPECT_NE(named("--within", "20 %").first.note.find("exact: "), std::string::npos);
  EXPECT_LE(named("bound", "of one node").first.ps, exact);
  EXPECT_LT(named("smaller image", "20 x 16").error(), 0.5);
  EXPECT_LT(named("fewer samples", "1 sample").error(), 0.5);
}

TEST(ErrorStudy, MoreSamplesAndDeeperRaysAreNearer) {
  EXPECT_GT(named("samples", "1 a pixel").error(), named("samples", "4 a pixel").error());
  EXPECT_GT(named("samples", "4 a pixel").error(), named("samples", "16 a pixel").error());
  EXPECT_GT(named("samples", "16 a pixel").error(), named("samples", "256 a pixel").noise);
  EXPECT_GT(named("depth", "1 ray").error(), named("depth", "3 rays").error());
  EXPECT_LT(named("precision", "float").error(), 1e-2);
  // Independent samples would give -1/2, cells of a grid over straight edges -3/4, over smooth parts -1.
  const std::optional<Exponent> exponent = exponent_of(gears(), "samples");
  ASSERT_TRUE(exponent);
  EXPECT_LT(exponent->value, -0.45);
  EXPECT_GT(exponent->value, -1.1);
}

TEST(ErrorStudy, TheSameAgainButForRunTimes) {
  const std::vector<Setting> again = measured(read(small_study));
  ASSERT_EQ(again.size(), gears().size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].error(), gears()[i].error()) << again[i].name;
    EXPECT_EQ(again[i].noise, gears()[i].noise);
  }
}

// Path tracing takes neither weights nor voxel cuts, curved primitives no voxel cut.
TEST(ErrorStudy, KnobsThatTheFrameHasNotAreLeftOut) {
  const auto has = [](const std::string& text, std::string_view way) {
    const ErrorConfig config = read(text);
    std::vector<Setting> settings;
    add_image_knobs(config, settings);
    return std::ranges::any_of(settings, [&](const Setting& setting) { return setting.way == way; });
  };
  EXPECT_TRUE(has("scene.source = \"gears:1\"\n", "voxel cut"));
  EXPECT_FALSE(has("scene.source = \"balls:1\"\n", "voxel cut"));
  EXPECT_FALSE(has("scene.source = \"gears:1\"\nstructure.kind = \"bvh\"\n", "voxel cut"));
  const std::string path = "scene.source = \"gears:1\"\nimage.integrator = \"path\"\n";
  EXPECT_FALSE(has(path, "voxel cut"));
  EXPECT_FALSE(has(path, "weight"));
  EXPECT_TRUE(has(path, "samples"));
}

std::vector<Setting> with_errors(const std::vector<std::pair<double, double>>& values_and_errors,
                                 double noise) {
  std::vector<Setting> settings(1);
  settings[0].noise = noise;
  settings[0].seconds = {8.0};
  for (const auto& [value, error] : values_and_errors) {
    Setting& setting = settings.emplace_back();
    setting.way = "samples";
    setting.value = value;
    setting.drawn = true;
    setting.squares = 2.0 * error * error;
    setting.seconds = {1.0, 1.0};
  }
  return settings;
}

TEST(Exponent, OfAPowerLawIsItsOwnAndItsIntervalHolds) {
  const std::optional<Exponent> exact =
      exponent_of(with_errors({{1, 0.3}, {4, 0.15}, {16, 0.075}, {64, 0.001}}, 0.01), "samples");
  ASSERT_TRUE(exact);
  EXPECT_NEAR(exact->value, -0.5, 1e-12);
  EXPECT_NEAR(exact->half_width, 0.0, 1e-6);
  EXPECT_DOUBLE_EQ(exact->to, 16.0) << "64 samples are below the noise";
  EXPECT_FALSE(exponent_of(with_errors({{1, 0.3}}, 0.0), "samples"));
  EXPECT_TRUE(std::isinf(exponent_of(with_errors({{1, 0.3}, {2, 0.2}}, 0.0), "samples")->half_width));
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.1);
  int covered = 0;
  constexpr int trials = 500;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<std::pair<double, double>> noisy;
    for (const double n : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
      noisy.emplace_back(n, 0.3 * std::pow(n, -0.4) * std::exp(normal(random)));
    }
    const Exponent found = *exponent_of(with_errors(noisy, 0.0), "samples");
    covered += std::abs(found.value + 0.4) <= found.half_width ? 1 : 0;
  }
  EXPECT_NEAR(covered, 0.95 * trials, 25.0);
}

TEST(ErrorStudy, TheCheapestMeetsTheTargetAndNothingCheaperDoes) {
  std::size_t answers = 1;  // that of the exponent
  for (std::size_t exact = 0; exact < gears().size(); ++exact) {
    if (gears()[exact].exact != exact) {
      continue;
    }
    ++answers;
    for (const double target : targets) {
      const Setting& best = gears()[cheapest(gears(), exact, target)];
      EXPECT_EQ(best.exact, exact);
      EXPECT_LE(best.error(), target);
      for (const Setting& other : gears()) {
        EXPECT_FALSE(other.exact == exact && std::max(other.error(), gears()[exact].noise) <= target &&
                     median(other.seconds) < median(best.seconds));
      }
    }
  }
  EXPECT_EQ(answers_of(gears()).size(), answers);
  EXPECT_EQ(error_table(gears()).rows().size(), gears().size());
}

TEST(ErrorStudy, MedianOfOddAndEven) {
  EXPECT_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(median({1.0, 2.0}), 1.5);
}

/// A closed room all of whose walls reflect a share and emit: every ray chain goes on for ever, and the light
/// that comes after depth d is known.
scenes::Scene mirror_room(double reflection) {
  scenes::Scene scene;
  scenes::Material wall;
  wall.diffuse = 0.0;
  wall.emission = {1.0, 1.0, 1.0};
  wall.reflection = reflection;
  wall.specular_color = {1.0, 1.0, 1.0};
  scene.materials.push_back(wall);
  for (int i = 0; i < 8; ++i) {
    scene.positions.emplace_back((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.5 : -1.5,
                                 (i & 4) != 0 ? 2.0 : -2.0);
  }
  const std::uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& side : sides) {
    const auto polygon = static_cast<std::uint32_t>(scene.polygons++);
    scene.triangles.push_back({{side[0], side[1], side[2]}, 0, polygon});
    scene.triangles.push_back({{side[0], side[2], side[3]}, 0, polygon});
  }
  scene.camera.eye = {0.1, 0.2, 0.3};
  scene.camera.at = {0.7, -0.4, -1.0};
  scene.camera.up = {0.0, 1.0, 0.0};
  return scene;
}

TEST(ErrorStudy, ADepthCutLosesTheRestOfAGeometricSeries) {
  for (const double r : {0.3, 0.8}) {
    const scenes::Scene scene = mirror_room(r);
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const auto structure = accel::make_structure("octree", triangles);
    processors::program::RenderOptions options{.width = 8, .height = 8, .max_depth = 60};
    const processors::program::Image deep =
        processors::program::render(scene, *triangles, *structure, options).image;
    for (const std::uint32_t depth : {1U, 2U, 5U, 12U}) {
      options.max_depth = depth;
      const Answer answer{0.0, processors::program::render(scene, *triangles, *structure, options).image, ""};
      // Light of emission 1 after d, d + 1, ... reflections: r^d / (1 - r), of 1 / (1 - r) in all.
      EXPECT_NEAR(error_of(answer, {0.0, deep, ""}), std::pow(r, depth) - std::pow(r, 60), 2e-5)
          << r << depth;
    }
  }
}

TEST(ErrorKeys, AreReadSortedAndRefusedWithFileLineAndKey) {
  EXPECT_EQ(read("error.samples = [8, 2, 8]\n").samples, (std::vector<std::uint32_t>{2, 8}));
  const auto expect = [](const std::string& text, const std::string& key, const std::string& reason) {
    const std::string message = test::user_error_of([&] { (void)read(text); });
    EXPECT_NE(message.find("error.toml:2"), std::string::npos) << message;
    EXPECT_NE(message.find(key), std::string::npos) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  };
  expect("[error]\nsamples = [65]\n", "error.samples", "64");
  expect("[error]\ndepths = [1, 33]\n", "error.depths", "32");
  expect("[error]\nweights = [0.0]\n", "error.weights", "");
  expect("[error]\nwithin = [1.5]\n", "error.within", "");
  expect("[image]\nvoxel_cut = 1.0\n", "image.voxel_cut", "the study sets it itself");
  expect("[error]\nsample = [1]\n", "error.sample", "samples");
}

}  // namespace
}  // namespace marti::studies
