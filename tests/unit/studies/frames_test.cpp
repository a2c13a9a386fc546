// The study of frames as a whole.
#include "studies/frames/frames.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config.h"
#include "studies/frames/frames_config.h"
#include "studies/run/functional_run.h"
#include "studies/run/run_result.h"
#include "studies/tables/csv.h"
#include "tests/support/study_tables.h"
#include "tests/support/wrong_configurations.h"

namespace marti::studies {

using namespace frames;
using namespace keys;
using namespace run;
using namespace tables;

using test::table_of;

namespace {

const std::string swing = "[scene]\nsource = \"" MARTI_SOURCE "/configs/scenes/swing.glb\"\n";
const std::string small =
    "[frames]\ncount = 3\nfirst = 2\nrate = 8\n[image]\nwidth = 32\nheight = 24\nmax_depth = 2\n"
    "[machine]\nnodes = 3\n";

StudyOutput run(const std::string& text, int threads = 2) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  sim::Config config = sim::Config::from_text(run_schema(), text, "frames.toml");
  return run_frames(config);
}

TEST(Frames, GivesTheSameBytesAtAnyNumberOfThreads) {
  const StudyOutput one = run(swing + small, 1);
  const StudyOutput two = run(swing + small, 2);
  ASSERT_EQ(one.tables.size(), two.tables.size());
  for (std::size_t i = 0; i < one.tables.size(); ++i) {
    EXPECT_EQ(csv_of(one.tables[i]), csv_of(two.tables[i])) << one.tables[i].name();
  }
  EXPECT_EQ(one.report, two.report);
  ASSERT_EQ(one.images.size(), 3U);
  for (std::size_t i = 0; i < one.images.size(); ++i) {
    EXPECT_EQ(one.images[i].image.pixels, two.images[i].image.pixels);
  }
}

TEST(Frames, ImagesAreThoseOfRunsOfOneFrame) {
  for (const char* walk : {"", "[structure]\nmailboxes = true\n"}) {
    const StudyOutput study = run(swing + small + walk);
    for (std::uint32_t i = 0; i < 3; ++i) {
      sim::Config config = sim::Config::from_text(
          run_schema(), swing + small + walk, "frames.toml",
          std::vector<std::string>{"frames.count=1", "frames.first=" + std::to_string(2 + i)});
      const FunctionalRun one = run_functional(read_frame(config));
      EXPECT_EQ(study.images[i].name, "frame-000" + std::to_string(2 + i));
      EXPECT_EQ(study.images[i].image.pixels, one.frame.image.pixels);
    }
  }
}

TEST(Frames, VerifyingChangesNothingElse) {
  const StudyOutput with = run(swing + small);
  const StudyOutput without = run(swing + "[frames]\nverify = false\n" + small.substr(9));
  for (const char* name : {"frames", "cycles", "totals"}) {
    EXPECT_EQ(csv_of(table_of(with, name)), csv_of(table_of(without, name))) << name;
  }
  EXPECT_NE(with.report, without.report) << "it says whether the images were compared";
}

TEST(Frames, TheVoxelCutIsVerifiedWithTheSameCells) {
  const StudyOutput cut =
      run(swing + "[frames]\ncount = 2\n[image]\nwidth = 32\nheight = 24\nmax_depth = 2\nvoxel_cut = 2.0\n");
  EXPECT_EQ(cut.images.size(), 2U);
}

TEST(Frames, TotalsAreSumsOfCycles) {
  const StudyOutput output = run(swing + small);
  const Table& cycles = table_of(output, "cycles");
  const Table& totals = table_of(output, "totals");
  ASSERT_EQ(cycles.rows().size(), 12U);
  ASSERT_EQ(totals.rows().size(), 4U);
  for (const char* column : {"build", "render", "cycle", "building", "splits"}) {
    for (std::size_t way = 0; way < 4; ++way) {
      std::int64_t sum = 0;
      for (std::size_t frame = 0; frame < 3; ++frame) {
        EXPECT_EQ(cycles.at(4 * frame + way, "way"), totals.at(way, "way"));
        sum += std::get<std::int64_t>(cycles.at(4 * frame + way, column));
      }
      EXPECT_EQ(std::get<std::int64_t>(totals.at(way, column)), sum) << column;
    }
  }
}

TEST(Frames, AStillSceneIsKept) {
  const StudyOutput output = run("[scene]\nsource = \"tetra:3\"\n" + small);
  const Table& frames = table_of(output, "frames");
  for (std::size_t row = 1; row < frames.rows().size(); ++row) {
    EXPECT_EQ(std::get<double>(frames.at(row, "kept")), 1.0);
    EXPECT_EQ(frames.at(row, "image_hash"), frames.at(0, "image_hash"));
  }
  const StudyOutput one = run("[scene]\nsource = \"tetra:3\"\n[image]\nwidth = 16\nheight = 16\n");
  EXPECT_EQ(table_of(one, "frames").rows().size(), 1U);
  EXPECT_EQ(table_of(one, "totals").at(0, "later_saved"), Cell());
}

TEST(Frames, TreesAreSharedUnlessToldOtherwise) {
  const auto sharing = [](const std::string& text) {
    sim::Config config = sim::Config::from_text(run_schema(), text, "frames.toml");
    return read_frames(config).machine.build;
  };
  EXPECT_EQ(sharing("").sharing, processors::machine::Sharing::shared);
  EXPECT_EQ(sharing("[build]\ninitial_level = \"3\"\n").level, 3U);
  EXPECT_EQ(sharing("[build]\nrule_k = 3.0\n").rule_k, 3.0);
  EXPECT_EQ(sharing("[build]\nsharing = \"private\"\n").sharing, processors::machine::Sharing::private_trees);
  EXPECT_EQ(sharing("[database]\nplacement = \"replicated\"\n").sharing,
            processors::machine::Sharing::private_trees);
  EXPECT_EQ(sharing("[database]\nplacement = \"distributed\"\n").sharing,
            processors::machine::Sharing::private_trees);
}

TEST(Frames, WrongConfigurationsAreRefused) {
  const std::vector<test::WrongConfiguration> cases = {
      {"[frames]\ncount = 0\n", {"frames.toml:2", "frames.count"}},
      {"[frames]\ncount = 2000000\n", {"frames.toml:2", "frames.count"}},
      {"[frames]\ncount = 1000000\n", {"frames.toml:2", "frames.count", "host_machine.memory_limit"}},
      {"[frames]\nverify = 1\n", {"frames.toml:2", "frames.verify"}},
      {"[structure]\nkind = \"bsp\"\n", {"frames.toml:2", "structure.kind", "octree"}},
      {"[build]\nsharing = \"given\"\n", {"frames.toml:2", "build.sharing", "shared"}},
      {"[build]\nsharing = \"none\"\n", {"frames.toml:2", "build.sharing", "private"}},
      {"[build]\ninitial_level = \"0\"\n", {"frames.toml:2", "build.initial_level"}},
      {"[build]\ninitial_level = \"full\"\nrule_k = 3.0\n", {"frames.toml:3", "build.rule_k"}},
      {"[build]\nsharing = \"shared\"\n[database]\nplacement = \"replicated\"\n",
       {"frames.toml:2", "build.sharing", "private"}},
      {"[interconnect]\narbitration = \"round_robin\"\n", {"interconnect.arbitration", "fifo", "private"}},
      {"[image]\nvoxel_cut = 1.0\nvoxel_cut_reference = true\n",
       {"frames.toml:3", "image.voxel_cut_reference"}},
      {"[machine]\nnodes = 65536\n[cache]\nsize = \"16 MiB\"\n", {"frames.toml:2", "machine.nodes"}},
      {"[scene]\nsource = \"no.glb\"\n", {"no.glb"}},
      {"[scene]\nsource = \"teapott:2\"\n", {"teapot"}},
      {"[host_machine]\nmemory_limit = \"4 MiB\"\n", {"memory_limit"}},
  };
  test::expect_refusals(cases, [](const char* text) { run(text); });
}

}  // namespace
}  // namespace marti::studies
