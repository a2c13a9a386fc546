// The paper's arguments about parallel machines, of which only directions are tested, on a small image.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/config.h"
#include "studies/run/functional_run.h"
#include "studies/schemes/arguments.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/schemes/tree_tables.h"

namespace marti::tests {
namespace {

using namespace studies::run;
using namespace studies::schemes;
using namespace studies::tables;

/// The shipped study, of a smaller image.
const SchemesConfig& shipped() {
  static const SchemesConfig schemes = [] {
    const std::vector<std::string> smaller = {"image.width=96", "image.height=96",
                                              "schemes.nodes=[1,4,16,64]", "schemes.cell_levels=[5,7,11]"};
    sim::Config config = sim::Config::from_file(
        schemes_schema(), std::filesystem::path(MARTI_SOURCE) / "configs" / "schemes.toml", smaller);
    return read_schemes(config);
  }();
  return schemes;
}

const processors::program::WorkLog& log() {
  static const FunctionalRun run = run_functional(shipped().frame);
  return *run.frame.log;
}

const std::vector<StagePoint>& stages() {
  static const std::vector<StagePoint> points = time_stages(shipped(), log());
  return points;
}

const std::vector<ScalingPoint>& points() {
  static const std::vector<ScalingPoint> all = time_machines(shipped(), log(), stages());
  return all;
}

double efficiency(const ScalingPoint& point) { return point.efficiency.value(); }

TEST(Arguments, NaiveSharedMemorySaturates) {
  const std::vector<ScalingPoint> naive = points_of(points(), "naive_pixel");
  ASSERT_EQ(naive.size(), 4U);
  EXPECT_GT(naive.back().interconnect.value(), 0.99);
  // Sixteen times as many nodes gain nothing.
  EXPECT_LT(naive[3].speed_up.value(), 1.05 * naive[1].speed_up.value());
  EXPECT_LT(naive.back().speed_up.value(), 3.0);
}

TEST(Arguments, PacketsWithCachesSaturateMuchLater) {
  const std::vector<ScalingPoint> naive = points_of(points(), "naive_pixel");
  const std::vector<ScalingPoint> cached = points_of(points(), "marti");
  EXPECT_GT(half_efficiency_nodes(cached).value(), 4.0 * half_efficiency_nodes(naive).value());
  EXPECT_GT(cached.back().hit_ratio.value(), 0.8);
}

TEST(Arguments, SpaceParallelEfficiencyFalls) {
  const std::vector<ScalingPoint> space = points_of(points(), "space");
  ASSERT_EQ(space.size(), 4U);
  for (std::size_t i = 1; i < space.size(); ++i) {
    EXPECT_LT(efficiency(space[i]), efficiency(space[i - 1])) << space[i].nodes;
  }
  EXPECT_LT(half_efficiency_nodes(space).value(), 40.0);
  // At sixteen nodes packets with caches are still far ahead.
  EXPECT_GT(efficiency(points_of(points(), "marti")[2]), 1.3 * efficiency(space[2]));
}

TEST(Arguments, APipelineIsLimitedByItsSlowestStage) {
  ASSERT_GT(stages().size(), 1U);
  for (const StagePoint& point : stages()) {
    for (std::size_t stage = 0; stage < processors::machine::pipeline_stages; ++stage) {
      EXPECT_LE(point.busy[stage], point.busy[point.slowest()]);
    }
  }
  // Moving a node from the least busy stage to the slowest helps, as long as one stage is the slowest.
  const StagePoint& first = stages().front();
  EXPECT_GT(first.busy[first.slowest()], 0.8);
  EXPECT_LT(stages()[1].end, first.end);
}

TEST(Arguments, TooSmallAndTooLargeCellsBothHurtTheCache) {
  const std::vector<CellPoint> cells = time_cells(shipped());
  ASSERT_EQ(cells.size(), 3U);
  const auto misses = [&](std::size_t i) { return cells[i].tree.references.all_misses(); };
  EXPECT_GT(misses(0), 2 * misses(1));
  EXPECT_GT(4 * misses(2), 5 * misses(1));
  EXPECT_GT(cells[0].tree.end, cells[1].tree.end);
  const std::vector<Claim> claims = check_arguments({}, cells, {});
  EXPECT_EQ(claims.back().verdict, Verdict::agrees) << claims.back().here;
}

// Each with records of its own size; the hits, and so the points shaded, are the same.
TEST(Arguments, StructuresAreComparedOnOneMachine) {
  SchemesConfig config = shipped();
  config.structures = {{"octree", "octree"},
                       {"bvh:2", "bvh", accel::BvhNodeKind::two},
                       {"bvh:8", "bvh", accel::BvhNodeKind::eight},
                       {"bvh:8_quantised", "bvh", accel::BvhNodeKind::eight_quantised}};
  const std::vector<StructurePoint> points = time_structures(config);
  ASSERT_EQ(points.size(), 4U);
  for (const StructurePoint& point : points) {
    EXPECT_EQ(point.tree.steps.shades, points[0].tree.steps.shades) << point.name;
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_EQ(points[i].tree.tree_entries, points[1].tree.tree_entries) << "each primitive once";
    EXPECT_LT(points[i].tree.tree_entries, points[0].tree.tree_entries);
  }
  EXPECT_LT(points[2].tree.steps.branches, points[1].tree.steps.branches) << "a record holds more boxes";
  EXPECT_LT(points[3].tree.references.references(), points[2].tree.references.references())
      << "a record has fewer bytes";
}

TEST(Arguments, EveryOtherStatementOfTheShippedStudyIsMeasuredAndAgrees) {
  std::vector<Claim> claims = check_arguments(points(), {}, stages());
  EXPECT_EQ(claims.back().verdict, Verdict::not_measured);  // that about the cells
  claims.pop_back();
  for (const Claim& claim : claims) {
    EXPECT_EQ(claim.verdict, Verdict::agrees) << claim.subject << ": " << claim.here;
  }
}

TEST(Arguments, HalfTheEfficiencyIsFoundBetweenPoints) {
  std::vector<ScalingPoint> machine(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    machine[i].nodes = 1U << (2U * i);
    machine[i].efficiency = 1.0 - 0.375 * i;
  }
  EXPECT_NEAR(half_efficiency_nodes(machine).value(), 6.35, 0.01);  // 2^(2 + 2 * 1/3)
  machine[2].efficiency = 0.5;
  EXPECT_EQ(half_efficiency_nodes(machine), std::nullopt);
  // One node's efficiency is 1, whether it was timed or not.
  machine[0].nodes = 16;
  machine[0].efficiency = 0.25;
  EXPECT_NEAR(half_efficiency_nodes(machine).value(), 6.35, 0.01);  // 2^(4 * 2/3)
}

// With more nodes than packets the efficiency falls too, but the memory is not to blame.
TEST(Arguments, NodesWithoutPacketsSayNothingOfTheMemory) {
  std::vector<ScalingPoint> machines(6);
  for (std::uint32_t i = 0; i < 3; ++i) {
    machines[i].machine = "naive";
    machines[i].nodes = machines[i + 3].nodes = 1U << (2U * i);
    machines[i].efficiency = std::array{1.0, 0.1, 0.05}[i];
    machines[i].interconnect = machines[i + 3].interconnect = 0.95;
    machines[i + 3].machine = "cached";
    machines[i + 3].hit_ratio = 0.9;
    machines[i + 3].efficiency = std::array{1.0, 0.9, 0.3}[i];
  }
  const auto verdict = [&] { return check_arguments(machines, {}, {})[1].verdict; };
  EXPECT_EQ(verdict(), Verdict::agrees) << "half is left at 10 nodes and at 2";
  machines[5].limit = studies::figures::Limit::imbalance;
  EXPECT_EQ(verdict(), Verdict::not_measured);
}

TEST(Arguments, CellsThatDoNotDifferAreNotJudged) {
  std::vector<CellPoint> cells(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    cells[i].level = i + 1;
    cells[i].tree.references.hits[0] = 1000;
    cells[i].tree.references.misses[0] = 50;
  }
  const auto claim = [&] { return check_arguments({}, cells, {}).back(); };
  EXPECT_EQ(claim().verdict, Verdict::not_measured) << "the trees are alike";
  cells[1].tree.references.misses[0] = 60;
  cells[2].tree.references.misses[0] = 100;
  EXPECT_EQ(claim().verdict, Verdict::differs);
  EXPECT_EQ(claim().here,
            "fewest misses with level 1, the last tried on that side; 2.00 times as many with 3");
  cells[0].tree.references.hits[0] = 0;
  EXPECT_EQ(claim().verdict, Verdict::not_measured) << "no cache";
}

}  // namespace
}  // namespace marti::tests
