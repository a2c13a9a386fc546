// What a functional run reports about its structure; runs of the shipped configurations.
#include "studies/run/functional_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "scenes/procedural.h"
#include "sim/files.h"
#include "studies/run/run_result.h"
#include "studies/show/summary.h"

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
  const std::vector<std::string> small = {"image.width=24", "image.height=16", "scene.source=teapot:2",
                                          "frames.count=1"};
  int configurations = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(MARTI_SOURCE) / "configs")) {
    const std::string text =
        entry.path().extension() == ".toml" ? sim::read_file(entry.path(), 100'000) : "[paper]";
    // Configurations of studies are run by the tests of the studies.
    const auto is_of = [&](const char* section) { return text.find(section) != std::string::npos; };
    if (!is_of("[paper]") && !is_of("[schemes]") && !is_of("[error]")) {
      ++configurations;
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
