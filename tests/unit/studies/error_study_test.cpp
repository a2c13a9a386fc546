// The rendering family of `marti study error`: settings that must be exact are, errors behave as in theory,
// and the tables are the same at every run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "scenes/procedural.h"
#include "studies/error/error_keys.h"
#include "studies/error/median_interval.h"
#include "studies/error/rendering.h"
#include "studies/error/rendering_tables.h"
#include "studies/keys/machine_keys.h"
#include "studies/tables/csv.h"
#include "studies/tables/text_table.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace error;
using namespace keys;
using namespace tables;

namespace {

FrameConfig small_frame(const std::string& scene) {
  FrameConfig frame;
  frame.scene = scene;
  frame.structure = "octree";
  frame.render.width = 20;
  frame.render.height = 16;
  frame.render.max_depth = 4;
  frame.memory = sim::MemoryBudget(std::uint64_t{1} << 32U);
  return frame;
}

RenderingErrorOptions small_options() {
  RenderingErrorOptions options;
  options.samples = {1, 4, 16};
  options.reference_samples = 256;
  options.depths = {1, 2, 3};
  options.reference_depth = 8;
  options.weights = {0.1, 0.5};
  options.voxel_cuts = {1.0, 16.0};
  options.repeats = 2;
  return options;
}

std::vector<const RenderingPoint*> points_of(const RenderingStudy& study, Knob knob) {
  std::vector<const RenderingPoint*> points;
  for (const RenderingPoint& point : study.points) {
    if (point.setting.knob == knob) {
      points.push_back(&point);
    }
  }
  return points;
}

const RenderingStudy& jacks() {
  static const RenderingStudy study = measure_rendering(small_frame("gears:1"), small_options());
  return study;
}

TEST(RenderingError, WhatMustNotChangeTheImageDoesNot) {
  const auto exact = points_of(jacks(), Knob::exact);
  EXPECT_EQ(exact.size(), 22U);
  for (const RenderingPoint* point : exact) {
    EXPECT_EQ(point->errors.plain.rmse, 0.0) << point->setting.name;
    EXPECT_EQ(point->errors.plain.changed, 0U) << point->setting.name;
    EXPECT_FALSE(point->errors.first) << point->setting.name;
  }
  for (const RenderingPoint& point : jacks().points) {
    EXPECT_EQ(point.cpu_ms.size(), 2U);
    if (point.setting.reference) {
      EXPECT_EQ(point.errors.plain.changed, 0U) << point.setting.name;
    }
  }
}

TEST(RenderingError, MoreSamplesAndDeeperRaysAreNearer) {
  const auto samples = points_of(jacks(), Knob::samples);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_GT(samples[0]->errors.plain.rmse, samples[1]->errors.plain.rmse);
  EXPECT_GT(samples[1]->errors.plain.rmse, samples[2]->errors.plain.rmse);
  EXPECT_GT(samples[2]->errors.plain.rmse, jacks().noise_floor);
  EXPECT_EQ(samples[2]->work.rays[0], 20U * 16U * 16U);
  // Independent samples would give -1/2, cells of a grid over straight edges -3/4, over smooth parts -1.
  const std::optional<double> exponent = sample_exponent(jacks());
  ASSERT_TRUE(exponent);
  EXPECT_LT(*exponent, -0.45);
  EXPECT_GT(*exponent, -1.1);

  const auto depths = points_of(jacks(), Knob::depth);
  ASSERT_EQ(depths.size(), 4U);
  EXPECT_GT(depths[0]->errors.plain.rmse, 0.0);
  EXPECT_LE(depths[2]->errors.plain.rmse, depths[0]->errors.plain.rmse);
  EXPECT_LT(depths[0]->work.all_rays(), depths[3]->work.all_rays());
}

TEST(RenderingError, TablesDoNotDependOnTheRun) {
  const StudyOutput first = output_of(jacks());
  const StudyOutput second = rendering_error(small_frame("gears:1"), small_options());
  ASSERT_EQ(first.tables.size(), second.tables.size());
  for (std::size_t i = 0; i < first.tables.size(); ++i) {
    EXPECT_EQ(text_of(first.tables[i]), text_of(second.tables[i]));
  }
  EXPECT_EQ(first.report, second.report);
  EXPECT_EQ(first.tables[0].rows().size(), jacks().points.size());
  EXPECT_EQ(first.host_tables[0].rows().size(), jacks().points.size());
  EXPECT_NE(first.report.find("give every bit of the image"), std::string::npos);
}

TEST(RenderingError, TheCheapestMeetsTheTargetAndNothingCheaperDoes) {
  const std::vector<double> costs = counted_costs(jacks());
  for (const double target : rendering_targets) {
    for (std::size_t k = 0; k < knobs; ++k) {
      const auto knob = static_cast<Knob>(k);
      const std::optional<std::size_t> best = cheapest(jacks(), knob, target, costs);
      for (std::size_t i = 0; i < jacks().points.size(); ++i) {
        const RenderingPoint& point = jacks().points[i];
        if (point.setting.knob != knob || known_error(jacks(), point) > target) {
          continue;
        }
        ASSERT_TRUE(best);
        EXPECT_GE(costs[i], costs[*best]);
      }
      if (best) {
        EXPECT_LE(jacks().points[*best].errors.relative, target);
      }
    }
  }
}

TEST(RenderingError, TheFrontIsWhatNoOtherBeats) {
  const std::vector<double> costs = counted_costs(jacks());
  for (std::size_t k = 0; k < knobs; ++k) {
    const auto knob = static_cast<Knob>(k);
    const std::vector<std::size_t> front = front_of(jacks(), knob, costs);
    EXPECT_FALSE(front.empty());
    for (const std::size_t at : front) {
      for (std::size_t other = 0; other < costs.size(); ++other) {
        if (jacks().points[other].setting.knob == knob) {
          const double error = known_error(jacks(), jacks().points[at]);
          const double other_error = known_error(jacks(), jacks().points[other]);
          EXPECT_FALSE(costs[other] <= costs[at] && other_error < error);
          EXPECT_FALSE(costs[other] < costs[at] && other_error <= error);
        }
      }
    }
  }
}

TEST(RenderingError, CurvedPrimitivesHaveNoVoxelCutAndSaySo) {
  RenderingErrorOptions options = small_options();
  options.samples = {1};
  options.reference_samples = 16;
  options.repeats = 1;
  const RenderingStudy study = measure_rendering(small_frame("balls:1"), options);
  EXPECT_TRUE(points_of(study, Knob::voxel_cut).empty());
  ASSERT_EQ(study.plan.notes.size(), 1U);
  EXPECT_NE(study.plan.notes[0].find("curved primitives"), std::string::npos);
  EXPECT_EQ(points_of(study, Knob::exact).size(), 22U);
}

TEST(RenderingError, ReferencesOfMoreSamplesThanOneRenderingHasAreMeans) {
  FrameConfig frame = small_frame("gears:1");
  frame.render.width = 5;
  frame.render.height = 4;
  RenderingErrorOptions options = small_options();
  options.samples = {64};
  options.repeats = 1;
  options.reference_samples = 1024;
  const double one = measure_rendering(frame, options).noise_floor;
  options.reference_samples = 4096;
  const RenderingStudy study = measure_rendering(frame, options);
  EXPECT_EQ(study.reference_samples, 4096U);
  EXPECT_LT(study.noise_floor, one);
  EXPECT_GT(study.noise_floor, 0.0);
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

TEST(RenderingError, ADepthCutLosesTheRestOfAGeometricSeries) {
  for (const double r : {0.3, 0.8}) {
    const scenes::Scene scene = mirror_room(r);
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const auto structure = accel::make_structure("octree", triangles);
    processors::program::RenderOptions options{.width = 8, .height = 8, .max_depth = 60};
    const processors::program::Image deep =
        processors::program::render(scene, *triangles, *structure, options).image;
    for (const std::uint32_t depth : {1U, 2U, 5U, 12U}) {
      options.max_depth = depth;
      const RenderingErrors errors =
          rendering_errors(processors::program::render(scene, *triangles, *structure, options).image, deep);
      // Light of emission 1 after d, d + 1, ... reflections: r^d / (1 - r) with r <= 1.
      const double bound = std::pow(r, depth) / (1.0 - r);
      EXPECT_LE(errors.plain.largest, bound * (1.0 + 1e-5) + 1e-6) << r << " " << depth;
      EXPECT_NEAR(errors.plain.rmse, bound - std::pow(r, 60) / (1.0 - r), 1e-5 * bound + 1e-6);
    }
  }
}

TEST(RenderingError, FloatsChangeLittleInMostPixels) {
  const auto precision = points_of(jacks(), Knob::precision);
  ASSERT_EQ(precision.size(), 2U);
  const RenderingErrors& errors = precision[0]->errors;
  EXPECT_TRUE(precision[0]->setting.render.floats);
  EXPECT_GT(errors.plain.changed, 0U);
  EXPECT_LT(errors.median_change, 1e-5);
  EXPECT_LT(errors.plain.visible, 20U * 16U / 20U) << "but for a few at edges";
}

TEST(Median, OfOddAndEven) {
  const MedianInterval odd = median_interval({5.0, 1.0, 3.0});
  EXPECT_EQ(odd.median, 3.0);
  EXPECT_EQ(odd.low, 1.0);
  EXPECT_EQ(odd.high, 5.0);
  EXPECT_DOUBLE_EQ(odd.confidence, 0.75);
  EXPECT_EQ(median_interval({1.0, 2.0}).median, 1.5);
  EXPECT_EQ(median_interval({4.0}).confidence, 0.0);
}

sim::Config config_of(const std::string& text) {
  return sim::Config::from_text(error_schema(), text, "error.toml");
}

std::string refusal(const std::string& text) {
  return test::user_error_of([&] {
    sim::Config config = config_of(text);
    const FrameConfig frame = read_frame(config);
    (void)read_rendering_error(config, frame);
    (void)read_machine(config);
    config.refuse_unused();
  });
}

TEST(RenderingErrorKeys, AreReadSortedAndRefusedWithFileLineAndKey) {
  sim::Config config = config_of("[error.rendering]\nsamples = [8, 2, 8]\nweights = [0.5, 0.1]\n");
  const FrameConfig frame = read_frame(config);
  const RenderingErrorOptions options = read_rendering_error(config, frame);
  EXPECT_EQ(options.samples, (std::vector<std::uint32_t>{2, 8}));
  EXPECT_EQ(options.weights, (std::vector<double>{0.1, 0.5}));
  EXPECT_EQ(options.reference_samples, 1024U);
  EXPECT_EQ(refusal(""), "no UserError");
  const auto expect = [](const std::string& text, const std::string& key, const std::string& reason) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find("error.toml:2"), std::string::npos) << message;
    EXPECT_NE(message.find(key), std::string::npos) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  };
  expect("[error.rendering]\nsamples = []\n", "error.rendering.samples", "empty");
  expect("[error.rendering]\nreference_samples = 1000\n", "error.rendering.reference_samples", "1024");
  expect("[error.rendering]\ndepths = [1, 16]\n", "error.rendering.depths", "16 is not below");
  expect("[error.rendering]\nweights = [0.0]\n", "error.rendering.weights", "");
  expect("[image]\nvoxel_cut = 1.0\n", "image.voxel_cut", "the study sets it itself");
  expect("[error.rendering]\nsample = [1]\n", "error.rendering.sample", "samples");
}

}  // namespace
}  // namespace marti::studies
