// The study of the 1992 paper on small scenes.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "sim/config.h"
#include "sim/error.h"
#include "studies/paper/claims.h"
#include "studies/paper/figures.h"
#include "studies/paper/host_builds.h"
#include "studies/paper/paper.h"
#include "studies/paper/paper_keys.h"
#include "studies/tables/csv.h"
#include "tests/support/wrong_configurations.h"

namespace marti::tests {
namespace {

using studies::paper::bytes_of;
using studies::paper::count_lazy_levels;
using studies::tables::StudyOutput;
using studies::tables::Table;

constexpr const char* small =
    "[image]\nwidth = 32\nheight = 24\n[machine]\nnodes = 2\n[structure]\nmax_objects = 9\n[paper]\n"
    "scenes = [\"tetra:2\", \"teapot:4:pot\"]\nrun_scenes = [\"gears:1\", \"teapot:3:pot\"]\n"
    "run_depths = [2, 3]\nlevels = [1, 3, 5]\nhost_repetitions = 0\n";

StudyOutput run(const std::string& text, int threads = 2) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  sim::Config config = sim::Config::from_text(studies::paper::paper_schema(), text, "paper.toml");
  return studies::paper::run_paper(config);
}

const Table& table_of(const StudyOutput& output, std::string_view name) {
  for (const Table& table : output.tables) {
    if (table.name() == name) {
      return table;
    }
  }
  throw sim::InternalError("there is no table " + std::string(name));
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
  for (const char* name : {"figure1", "figure3"}) {
    const Table& table = table_of(output, name);
    double sum = 0.0;
    for (std::size_t row = 0; row < table.rows().size(); ++row) {
      sum += std::get<double>(table.at(row, "share"));
    }
    EXPECT_NEAR(sum, 2.0, 1e-9) << name << ": one for each of two runs";
  }
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

// The tree that the host builds while rays are traced is the one that the log says they need.
TEST(HostBuilds, LeaveTheTreeThatTheLogPredicts) {
  sim::Config config =
      sim::Config::from_text(studies::paper::paper_schema(), std::string(small) + "rules = [3.0]\n",
                             "paper.toml", std::vector<std::string>{"paper.host_repetitions=1"});
  const studies::paper::PaperConfig paper = studies::paper::read_paper(config);
  for (const studies::paper::PaperRun& run : paper.runs) {
    const studies::paper::TracedRun traced = studies::paper::trace_run(paper, run);
    const auto outcomes = studies::paper::measure_host(paper, traced);
    ASSERT_GE(outcomes.size(), 4U);
    for (const studies::paper::HostOutcome& outcome : outcomes) {
      SCOPED_TRACE(studies::paper::name_of(run) + " level " + std::to_string(outcome.initial.level));
      const studies::paper::LevelCount all =
          sum_of(count_lazy_levels(traced.log->topology, traced.visits.touched, outcome.initial.level));
      EXPECT_EQ(outcome.nodes, all.nodes());
      EXPECT_EQ(outcome.partial, all.partial);
      EXPECT_GE(outcome.build_seconds, 0.0);
      EXPECT_GT(outcome.render_seconds, 0.0);
    }
    EXPECT_EQ(outcomes.back().partial, 0U);
    EXPECT_GT(outcomes.front().partial, 0U);
  }
}

// The simulated machine, node by node and line by line, leaves the tree that a count over the log predicts;
// and building the whole tree before the frame takes the splits and the memory of all branches.
TEST(BuildTimes, LeaveTheTreeThatTheLogPredicts) {
  sim::Config config = sim::Config::from_text(studies::paper::paper_schema(), small, "paper.toml");
  const studies::paper::PaperConfig paper = studies::paper::read_paper(config);
  std::vector<studies::paper::TracedRun> traced;
  for (const studies::paper::PaperRun& run : paper.runs) {
    traced.push_back(studies::paper::trace_run(paper, run));
  }
  const std::vector<studies::paper::RunOutcomes> runs = studies::paper::time_initial_levels(paper, traced);
  ASSERT_EQ(runs.size(), traced.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const studies::paper::LevelOutcome& outcome : runs[i].levels) {
      const auto levels =
          count_lazy_levels(traced[i].log->topology, traced[i].visits.touched, outcome.initial.level);
      const studies::paper::LevelCount all = sum_of(levels);
      EXPECT_EQ(outcome.nodes, all.nodes()) << outcome.initial.level;
      EXPECT_EQ(outcome.partial, all.partial) << outcome.initial.level;
      EXPECT_EQ(outcome.splits, all.branches) << outcome.initial.level;
      EXPECT_EQ(outcome.bytes, bytes_of(levels, paper.machine.layout)) << outcome.initial.level;
      EXPECT_EQ(std::accumulate(outcome.time.begin(), outcome.time.end(), sim::Sum{0}),
                paper.machine.all_nodes() * outcome.total());
    }
    EXPECT_TRUE(runs[i].whole().initial.whole);
    EXPECT_EQ(runs[i].levels.front().build, 0) << "nothing is built beforehand at level 1";
    EXPECT_GT(runs[i].whole().build, 0);
  }
}

TEST(Tasks, TakeEveryTickOfANode) {
  processors::cost::TimeSums time{};
  std::iota(time.begin(), time.end(), sim::Ticks{1});
  const studies::paper::TaskTimes sums = studies::paper::tasks_of(time);
  EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), sim::Ticks{0}),
            std::accumulate(time.begin(), time.end(), sim::Sum{0}));
  for (const sim::Ticks sum : sums) {
    EXPECT_GT(sum, 0);
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
  for (const studies::tables::Claim& claim : studies::paper::check_build_claims({})) {
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
      {"[build]\nsharing = \"shared\"\n", {"paper.toml:2", "build.sharing", "paper.levels"}},
      {"[structure]\nkind = \"bsp\"\n", {"paper.toml:2", "structure.kind", "octree"}},
      {"[database]\nplacement = \"distributed\"\n", {"paper.toml:2", "database.placement"}},
      {"[interconnect]\narbitration = \"round_robin\"\n",
       {"paper.toml:2", "interconnect.arbitration", "fifo"}},
      {"[paper]\nscenes = []\n", {"paper.toml:2", "paper.scenes"}},
      {"[paper]\nscenes = [\"tetra:2\", \"tetra:2\"]\n", {"paper.toml:2", "paper.scenes", "tetra:2 twice"}},
      {"[paper]\nscenes = [\"teapott:4\"]\n", {"paper.toml:2", "paper.scenes", "teapot"}},
      {"[paper]\nscenes = [\"tetra:1\"]\nrun_scenes = [\"nothing\"]\nrun_depths = [2]\n",
       {"paper.toml:3", "paper.run_scenes", "nothing"}},
      {"[paper]\nrun_depths = [2]\n", {"paper.toml:2", "paper.run_depths", "4"}},
      {"[paper]\nrun_scenes = [\"tetra:1\", \"tetra:1\"]\nrun_depths = [2, 2]\n",
       {"paper.toml:2", "paper.run_scenes", "twice"}},
      {"[paper]\nlevels = [0]\n", {"paper.toml:2", "paper.levels"}},
      {"[paper]\nrules = [-1.0]\n", {"paper.toml:2", "paper.rules"}},
  };
  test::expect_refusals(cases, [](const char* text) { run(text); });
}

}  // namespace
}  // namespace marti::tests
