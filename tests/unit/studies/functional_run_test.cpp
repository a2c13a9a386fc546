// What a functional run reports about its structure; runs of the shipped configurations.
#include "studies/run/functional_run.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "scenes/procedural.h"
#include "sim/files.h"
#include "studies/run/run_result.h"
#include "studies/show/summary.h"
#include "tests/support/files.h"
#include "tests/support/ray_file.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace helps;
using namespace keys;
using namespace run;

namespace {

FrameConfig teapot(const char* structure, std::uint64_t max_entries) {
  FrameConfig config;
  config.scene = "teapot:4";
  config.structure = structure;
  config.structure_options.octree.max_entries = max_entries;
  config.structure_options.bsp.max_entries = max_entries;
  config.render.width = 8;
  config.render.height = 8;
  config.memory = sim::MemoryBudget(std::uint64_t{1} << 30U);
  return config;
}

TEST(FunctionalRun, SaysThatATreeWasCut) {
  for (const char* structure : {"octree", "bsp"}) {
    const FunctionalRun whole = run_functional(teapot(structure, std::uint64_t{1} << 25));
    const FunctionalRun cut = run_functional(teapot(structure, 2000));
    EXPECT_TRUE(whole.structure_notes.empty());
    ASSERT_EQ(cut.structure_notes.size(), 1U);
    EXPECT_NE(cut.structure_notes[0].find("division stopped"), std::string::npos);
    EXPECT_LT(cut.frame.log->topology.nodes.size(), whole.frame.log->topology.nodes.size());
    EXPECT_EQ(cut.image_hash, whole.image_hash);
  }
}

// What a run says of its parts while it works is complete, in order, and better known at the end.
TEST(ExpectedTimes, AreOfAllPartsOfARun) {
  const auto parts_of = [](const std::string& machine, Measuring help) {
    sim::Config config = sim::Config::from_text(
        run_schema(), "scene.source = \"teapot:4\"\nimage.width = 80\nimage.height = 80\n" + machine,
        "a.toml");
    sim::WorkMeter meter;
    progress::Foreseen foreseen;
    RunOptions options;
    options.meter = &meter;
    options.foreseen = &foreseen;
    options.what_helps = help;
    const RunResult result = run::run(config, std::move(options));
    EXPECT_EQ(result.frame_config.expected, nullptr) << "it ends with the run";
    std::vector<progress::ForeseenPart> parts = foreseen.parts();
    for (const progress::ForeseenPart& part : parts) {
      EXPECT_TRUE(std::isfinite(part.seconds) && part.seconds >= 0.0) << part.name;
    }
    EXPECT_TRUE(meter.state().part.starts_with(parts.back().name)) << meter.state().part;
    return parts;
  };
  const std::vector<progress::ForeseenPart> all = parts_of("machine.nodes = 4\n", Measuring::within_budget);
  ASSERT_EQ(all.size(), 6U);
  const std::vector<progress::ForeseenPart> one = parts_of("machine.nodes = 1\n", Measuring::none);
  ASSERT_EQ(one.size(), 5U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].name, all[i].name);
  }
  EXPECT_EQ(one[0].seconds, 0.0) << "no file is read";
  EXPECT_EQ(one[1].seconds, all[1].seconds) << "one scene";
  EXPECT_GT(all[3].seconds, 0.0);
  EXPECT_EQ(one[3].seconds, 0.0) << "one node walks the whole log";
  EXPECT_GT(all[5].seconds, 0.0);
}

// A frame of given rays is a rectangle that holds them all, with fewer pixels to spare than it has rows.
TEST(FunctionalRun, GivenRaysAreAFrame) {
  const test::TemporaryDirectory directory;
  for (const std::size_t rays : {1U, 63U, 1024U, 1025U, 5000U}) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < rays; ++i) {
      numbers.insert(numbers.end(), {0.001 * static_cast<double>(i), 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 99.0});
    }
    test::write(directory.path() / "rays.npy", test::ray_file<float>(numbers));
    sim::Config config = sim::Config::from_text(
        run_schema(), "scene.source = \"gears:1\"\nimage.integrator = \"rays\"\nimage.rays = \"rays.npy\"\n",
        (directory.path() / "a.toml").string());
    const FrameConfig frame = read_frame(config);
    const std::uint64_t pixels = std::uint64_t{frame.render.width} * frame.render.height;
    EXPECT_GE(pixels, rays);
    EXPECT_LT(pixels, rays + frame.render.height);
    EXPECT_EQ(frame.render.height, (rays + 1023) / 1024);
    const FunctionalRun run = run_functional(frame);
    EXPECT_EQ(run.totals.all_rays(), rays);
    EXPECT_EQ(run.totals.shades + run.totals.lights, 0U);
    EXPECT_TRUE(test::says(run.notes.front(), "Rays of rays.npy: " + std::to_string(rays)))
        << run.notes.front();
  }
}

TEST(FunctionalRun, KeysWithoutAMeaningForGivenRaysAreRefused) {
  const test::TemporaryDirectory directory;
  test::write(directory.path() / "rays.npy", test::ray_file({0.0, 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 99.0}));
  const auto refusal_of = [&](const std::string& settings) {
    sim::Config config = sim::Config::from_text(
        run_schema(), "scene.source = \"gears:1\"\nimage.integrator = \"rays\"\n" + settings,
        (directory.path() / "a.toml").string());
    return test::user_error_of([&] { (void)run::run(config, {}); });
  };
  EXPECT_TRUE(test::says(refusal_of(""), "name it with image.rays"));
  EXPECT_TRUE(test::says(refusal_of("image.rays = \"none.npy\""), "a.toml:3: image.rays: there is no file"));
  EXPECT_TRUE(
      test::says(refusal_of("image.rays = \"a/../rays.npy/\""), "a.toml:3: image.rays: there is no file"));
  for (const char* const setting : {"image.width = 8",
                                    "image.height = 8",
                                    "image.region = [0, 0, 1, 1]",
                                    "image.samples = 1",
                                    "image.seed = 2",
                                    "image.max_depth = 1",
                                    "image.min_weight = 0.0",
                                    "image.shadows = true",
                                    "image.voxel_cut = 1.0",
                                    "image.voxel_cut_reference = true",
                                    "scene.camera = \"0\"",
                                    "scene.eye = [0, 0, 1]",
                                    "scene.look_at = [0, 0, 1]",
                                    "scene.up = [0, 0, 1]",
                                    "scene.field_of_view = 10.0",
                                    "scene.sky = [1, 1, 1]",
                                    "scene.sun = [1, 1, 1]",
                                    "scene.sun_color = [1, 1, 1]",
                                    "scene.default_light = \"never\"",
                                    "packets.order = \"morton\""}) {
    const std::string refusal = refusal_of("image.rays = \"rays.npy\"\n" + std::string(setting));
    EXPECT_TRUE(test::says(refusal, "a.toml:4: ") && test::says(refusal, " is not used: ") &&
                test::says(refusal, "rays"))
        << setting << ": " << refusal;
  }
}

// Also where the window's rays meet only some of the materials, so that the plan leaves others out.
TEST(FunctionalRun, APixelOfARegionIsThatOfTheImage) {
  for (const char* integrator : {"whitted", "path"}) {
    for (const int samples : {1, 3}) {
      const auto run_of = [&](const std::string& region) {
        sim::Config config = sim::Config::from_text(
            run_schema(),
            fmt::format("scene.source = \"gears:1\"\nimage.width = 30\nimage.height = 20\n"
                        "image.integrator = \"{}\"\nimage.samples = {}\nimage.region = {}\n",
                        integrator, samples, region),
            "a.toml");
        return run_functional(read_frame(config));
      };
      const FunctionalRun whole = run_of("[]");
      std::uint64_t rays = 0;
      for (std::uint32_t left = 0; left < 30; left += 10) {
        for (std::uint32_t top = 0; top < 20; top += 5) {
          const FunctionalRun part = run_of(fmt::format("[{}, {}, 10, 5]", left, top));
          rays += part.totals.all_rays();
          for (std::uint32_t i = 0; i < 50; ++i) {
            ASSERT_EQ(part.frame.image.at(i % 10, i / 10), whole.frame.image.at(left + i % 10, top + i / 10));
          }
        }
      }
      EXPECT_EQ(rays, whole.totals.all_rays());
      EXPECT_EQ(run_of("[0, 0, 30, 20]").image_hash, whole.image_hash);
    }
  }
}

TEST(FunctionalRun, ARegionOutsideTheImageIsRefusedInOneMessage) {
  for (const auto& [region, message] : std::vector<std::pair<std::string, std::string>>{
           {"[0, 0, 10]", "must be [left, top, width, height], not 3 numbers"},
           {"[0, 0, 0, 1]", "has no pixels"},
           {"[0, 0, 1, 0]", "has no pixels"},
           {"[30, 0, 1, 1]", "reaches to column 31 and row 1 of an image of 30 x 20 pixels"},
           {"[0, 1, 30, 20]", "reaches to column 30 and row 21 of an image of 30 x 20 pixels"},
           {"[32768, 32768, 32768, 32768]", "reaches to column 65536"},
           {"[-1, 0, 1, 1]", "must be 0 to 32768"}}) {
    const std::string found = test::user_error_of([&, text = region] {
      sim::Config config = sim::Config::from_text(
          run_schema(), "image.width = 30\nimage.height = 20\nimage.region = " + text + "\n", "a.toml");
      (void)read_frame(config);
    });
    EXPECT_NE(found.find(":3: image.region"), std::string::npos) << found;
    EXPECT_NE(found.find(message), std::string::npos) << found;
  }
}

// Nothing hides the sky from a floor in the open, so the ambient light of the one integrator is what the
// other's rays find.
TEST(FunctionalRun, ASkyAndASunLightAFloorAlikeForBothIntegrators) {
  const test::TemporaryDirectory directory;
  test::write(
      directory.path() / "floor.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "-100 -100 0\n100 -100 0\n100 100 0\n-100 100 0\n4 0 1 2 3\n");
  for (const char* integrator : {"whitted", "path"}) {
    sim::Config config = sim::Config::from_text(
        run_schema(),
        fmt::format("scene.source = \"{}\"\nscene.eye = [0, 0, 1]\nscene.look_at = [0, 9, 1]\n"
                    "scene.up = [0, 0, 1]\nscene.field_of_view = 90\nscene.sky = [0.25, 0.5, 1]\n"
                    "scene.sun = [3, 0, 4]\nscene.sun_color = [2, 1, 0]\nimage.width = 9\nimage.height = 9\n"
                    "image.integrator = \"{}\"\n",
                    (directory.path() / "floor.ply").string(), integrator),
        "a.toml");
    const FunctionalRun run = run_functional(read_frame(config));
    EXPECT_EQ(run.frame.image.at(4, 0), glm::vec3(0.25F, 0.5F, 1.0F)) << integrator;
    const glm::vec3 lit = 0.8F * (glm::vec3(0.25F, 0.5F, 1.0F) + 0.8F * glm::vec3(2.0F, 1.0F, 0.0F));
    EXPECT_LT(glm::distance(run.frame.image.at(4, 8), lit), 1e-6F) << integrator;
    EXPECT_EQ(run.frame.rays.traced[1], run.frame.rays.hit[0])
        << integrator << ": a shadow ray to the sun each";
  }
}

TEST(FunctionalRun, AWrongSkyOrSunIsRefused) {
  for (const auto& [line, message] : std::vector<std::pair<std::string, std::string>>{
           {"scene.sky = [1, 2]", "must be three numbers, [red, green, blue], not 2"},
           {"scene.sky = [1, -2, 1]", "scene.sky"},
           {"scene.sun = [0, 0, 0]", "must be a direction"},
           {"scene.sun = [1]", "must be three coordinates, [x, y, z], not 1"}}) {
    const std::string found = test::user_error_of([&, text = line] {
      sim::Config config = sim::Config::from_text(run_schema(), text, "a.toml");
      (void)read_frame(config);
    });
    EXPECT_NE(found.find("a.toml:1: scene.s"), std::string::npos) << found;
    EXPECT_NE(found.find(message), std::string::npos) << found;
  }
}

// A light that no float holds makes pixels infinite; the image says how many.
TEST(FunctionalRun, CountsPixelsThatAreNotFinite) {
  const FrameConfig config = teapot("octree", std::uint64_t{1} << 25);
  scenes::Scene scene = scenes::make_procedural(config.scene);
  const auto notes_of = [&] {
    const FunctionalRun run = run_functional(config, scene);
    const auto infinite = std::count_if(
        run.frame.image.pixels.begin(), run.frame.image.pixels.end(), [](const glm::vec3& pixel) {
          return !(std::abs(pixel.x) < std::numeric_limits<float>::infinity() &&
                   std::abs(pixel.y) < std::numeric_limits<float>::infinity() &&
                   std::abs(pixel.z) < std::numeric_limits<float>::infinity());
        });
    EXPECT_EQ(run.notes.size() == 1 && run.notes[0].starts_with(std::to_string(infinite) + " of 64 pixels"),
              infinite > 0);
    return infinite;
  };
  EXPECT_EQ(notes_of(), 0);
  ASSERT_FALSE(scene.lights.empty());
  for (scenes::Light& light : scene.lights) {
    light.color = glm::dvec3(1e200);
  }
  EXPECT_GT(notes_of(), 0);
}

TEST(Run, EveryShippedConfigurationCanBeRun) {
  namespace fs = std::filesystem;
  std::vector<std::string> small = {"image.width=24", "image.height=16", "frames.count=1", ""};
  int configurations = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(MARTI_SOURCE) / "configs")) {
    const std::string text =
        entry.path().extension() == ".toml" ? sim::read_file(entry.path(), 100'000) : "[paper]";
    // Configurations of studies are run by the tests of the studies.
    const auto is_of = [&](const char* section) { return text.find(section) != std::string::npos; };
    if (!is_of("[paper]") && !is_of("[error]") && !is_of("[suite")) {
      ++configurations;
      small.back() = is_of("\"gaussians\"") ? "scene.source=gaussians:2" : "scene.source=teapot:2";
      sim::Config config = sim::Config::from_file(run_schema(), entry.path(), small);
      const std::string summary =
          show::summary_of(run::run(config, {.what_helps = Measuring::within_budget}));
      for (const char* line : {"frame time", "speed-up", "hit ratio", "what helps"}) {
        EXPECT_NE(summary.find(line), std::string::npos) << entry.path() << " lacks " << line;
      }
    }
  }
  EXPECT_GE(configurations, 20);
}

}  // namespace
}  // namespace marti::studies
