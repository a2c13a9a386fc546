// The study of the 1992 paper on small scenes.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "processors/replay/replay.h"
#include "sim/config.h"
#include "sim/error.h"
#include "studies/paper/claims.h"
#include "studies/paper/figures.h"
#include "studies/paper/paper.h"
#include "studies/paper/paper_keys.h"
#include "studies/paper/traced_run.h"
#include "studies/run/open_frame.h"
#include "studies/tables/csv.h"
#include "tests/support/study_tables.h"
#include "tests/support/wrong_configurations.h"

namespace marti::tests {
using test::table_of;

namespace {

using studies::paper::bytes_of;
using studies::paper::count_lazy_levels;
using studies::tables::StudyOutput;
using studies::tables::Table;

constexpr const char* small =
    "[image]\nwidth = 32\nheight = 24\n[structure]\nmax_objects = 9\n[paper]\n"
    "scenes = [\"tetra:2\", \"teapot:4:pot\"]\nrun_scenes = [\"gears:1\", \"teapot:3:pot\"]\n"
    "run_depths = [2, 3]\n";

StudyOutput run(const std::string& text, int threads = 2) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  sim::Config config = sim::Config::from_text(studies::paper::paper_schema(), text, "paper.toml");
  return studies::paper::run_paper(config);
}

std::int64_t integer(const Table& table, std::size_t row, std::string_view column) {
  return std::get<std::int64_t>(table.at(row, column));
}

TEST(Paper, GivesTheSameBytesAtAnyNumberOfThreads) {
  const StudyOutput one = run(small, 1);
  const StudyOutput two = run(small, 2);
  ASSERT_EQ(one.tables.size(), two.tables.size());
  for (std::size_t i = 0; i < one.tables.size(); ++i) {
    EXPECT_EQ(studies::tables::csv_of(one.tables[i]), studies::tables::csv_of(two.tables[i]))
        << one.tables[i].name();
    EXPECT_FALSE(one.tables[i].rows().empty()) << one.tables[i].name();
  }
  EXPECT_EQ(one.report, two.report);
}

TEST(Paper, EveryNumberOfNodesHasBranchesAndLeaves) {
  const StudyOutput output = run(small);
  const Table& table = table_of(output, "table1");
  ASSERT_EQ(table.rows().size(), 4U);
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    EXPECT_EQ(integer(table, row, "nodes"), integer(table, row, "branches") + integer(table, row, "leaves"));
    // Every branch has 8 children or 2, and every node but the root is one's child.
    const bool octree = std::get<std::string>(table.at(row, "structure")) == "octree";
    EXPECT_EQ(integer(table, row, "nodes"), (octree ? 8 : 2) * integer(table, row, "branches") + 1);
    EXPECT_EQ(integer(table, row, "bytes"),
              8 * integer(table, row, "nodes") + 4 * integer(table, row, "entries"));
  }
}

TEST(Paper, SharesAddUpToOne) {
  const StudyOutput output = run(small);
  const Table& table = table_of(output, "figure3");
  double sum = 0.0;
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    sum += std::get<double>(table.at(row, "share"));
  }
  EXPECT_NEAR(sum, 2.0, 1e-9) << "one for each of two runs";
}

// The nodes of all levels together.
studies::paper::LevelCount sum_of(const std::vector<studies::paper::LevelCount>& levels) {
  studies::paper::LevelCount sum;
  for (const studies::paper::LevelCount& level : levels) {
    sum.branches += level.branches;
    sum.leaves += level.leaves;
    sum.partial += level.partial;
  }
  return sum;
}

studies::paper::PaperConfig small_config() {
  sim::Config config = sim::Config::from_text(studies::paper::paper_schema(), small, "paper.toml");
  return studies::paper::read_paper(config);
}

// The tree that this computer builds while rays are traced is the one that the log says they need.
TEST(HostBuilds, LeaveTheTreeThatTheLogPredicts) {
  const studies::paper::PaperConfig paper = small_config();
  for (const studies::paper::PaperRun& run : paper.runs) {
    const studies::paper::TracedRun traced = studies::paper::trace_run(paper, run);
    const studies::keys::FrameConfig frame = paper.frame_of(run);
    const scenes::Scene scene = studies::run::open_frame(frame);
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    for (const std::uint32_t level : {1U, 3U, 5U}) {
      accel::LazyOctreeOptions options;
      options.tree = frame.structure_options.octree;
      options.initial.level = level;
      const auto structure = accel::make_lazy_octree(triangles, options);
      (void)processors::program::render(scene, *triangles, *structure, frame.render);
      const auto& lazy = dynamic_cast<const accel::StructureOf<accel::LazyOctree>&>(*structure).concrete();
      const studies::paper::LevelCount all =
          sum_of(count_lazy_levels(traced.log->topology, traced.visits.touched, level));
      EXPECT_EQ(lazy.state().all.nodes(), all.nodes()) << studies::paper::name_of(run) << " level " << level;
      EXPECT_EQ(lazy.state().all.pending, all.partial) << studies::paper::name_of(run) << " level " << level;
    }
  }
}

// The simulated machine, node by node and line by line, leaves the tree that a count over the log predicts;
// and building the whole tree before the frame takes the splits and the memory of all branches.
TEST(BuildTimes, LeaveTheTreeThatTheLogPredicts) {
  const studies::paper::PaperConfig paper = small_config();
  for (const studies::paper::PaperRun& run : paper.runs) {
    const studies::paper::TracedRun traced = studies::paper::trace_run(paper, run);
    for (const std::uint32_t level : {1U, 3U, 5U, 100U}) {
      processors::machine::MachineConfig machine;
      machine.nodes = 2;
      const bool whole = level > traced.levels.size();
      machine.build.sharing =
          whole ? processors::machine::Sharing::none : processors::machine::Sharing::shared;
      machine.build.initial =
          whole ? processors::machine::InitialTree::full : processors::machine::InitialTree::level;
      machine.build.level = level;
      const processors::node::BuildResult build = processors::replay::replay(*traced.log, machine).build;
      const auto levels = count_lazy_levels(traced.log->topology, traced.visits.touched, level);
      const studies::paper::LevelCount all = sum_of(levels);
      const processors::node::BuildLevel left = build.all_levels();
      const auto count = [](std::uint64_t number) { return static_cast<std::int64_t>(number); };
      EXPECT_EQ(left.branches + left.leaves + left.partial, count(all.nodes())) << level;
      EXPECT_EQ(left.partial, count(all.partial)) << level;
      EXPECT_EQ(build.counts().all_splits(), count(all.branches)) << level;
      EXPECT_EQ(left.node_bytes + left.list_bytes, count(bytes_of(levels, machine.layout))) << level;
      EXPECT_EQ(build.start_up == 0, level == 1) << "nothing is built beforehand at level 1";
    }
  }
}

TEST(Claims, SayWhatWasNotMeasured) {
  for (const studies::tables::Claim& claim : studies::paper::check_tree_claims({})) {
    EXPECT_EQ(claim.verdict, studies::tables::Verdict::not_measured) << claim.subject;
    EXPECT_EQ(claim.here, "");
  }
  for (const studies::tables::Claim& claim : studies::paper::check_access_claims({})) {
    EXPECT_EQ(claim.verdict, studies::tables::Verdict::not_measured) << claim.subject;
  }
}

// A tree that structure.max_level cuts off has none of the levels that the paper speaks of.
TEST(Claims, SayNothingOfLevelsThatTheTreeHasNot) {
  studies::paper::SceneTrees scene;
  scene.scene = "teapot:12:pot";
  scene.octree.levels = {{0, 1}, {8, 0}};
  scene.bsp.levels = scene.octree.levels;
  for (const studies::tables::Claim& claim : studies::paper::check_tree_claims(std::span(&scene, 1))) {
    if (claim.says.find("level") != std::string::npos) {
      EXPECT_EQ(claim.verdict, studies::tables::Verdict::not_measured) << claim.subject << claim.says;
    }
  }
}

TEST(Paper, WrongConfigurationsAreRefused) {
  const std::vector<test::WrongConfiguration> cases = {
      {"[scene]\nsource = \"tetra:2\"\n", {"paper.toml:2", "scene.source", "paper.run_scenes"}},
      {"[image]\nmax_depth = 3\n", {"paper.toml:2", "image.max_depth"}},
      {"[structure]\nkind = \"bsp\"\n", {"paper.toml:2", "structure.kind", "octree"}},
      {"[paper]\nscenes = []\n", {"paper.toml:2", "paper.scenes"}},
      {"[paper]\nscenes = [\"tetra:2\", \"tetra:2\"]\n", {"paper.toml:2", "paper.scenes", "tetra:2 twice"}},
      {"[paper]\nscenes = [\"teapott:4\"]\n", {"paper.toml:2", "paper.scenes", "teapot"}},
      {"[paper]\nscenes = [\"tetra:1\"]\nrun_scenes = [\"nothing\"]\nrun_depths = [2]\n",
       {"paper.toml:3", "paper.run_scenes", "nothing"}},
      {"[paper]\nrun_depths = [2]\n", {"paper.toml:2", "paper.run_depths", "4"}},
      {"[paper]\nrun_scenes = [\"tetra:1\", \"tetra:1\"]\nrun_depths = [2, 2]\n",
       {"paper.toml:2", "paper.run_scenes", "twice"}},
      {"[machine]\nnodes = 2\n", {"paper.toml:2", "machine.nodes"}},
      {"[paper]\nrules = [-1.0]\n", {"paper.toml:2", "paper.rules"}},
  };
  test::expect_refusals(cases, [](const char* text) { run(text); });
}

}  // namespace
}  // namespace marti::tests
