// Tables of initial levels from hand-made outcomes.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "studies/paper/building_table.h"

namespace marti::tests {
namespace {

using studies::paper::LevelCount;
using studies::paper::LevelOutcome;
using studies::paper::RunOutcomes;
using studies::tables::Table;

LevelCount level(std::uint64_t branches, std::uint64_t leaves) {
  LevelCount count;
  count.branches = branches;
  count.leaves = leaves;
  return count;
}

TEST(InitialLevels, AreTheListTheRulesAndTheWholeTree) {
  studies::paper::PaperConfig config;
  config.levels = {1, 2, 4, 9};
  config.rules = {3.0, 10.0, 1e6};
  const std::vector<LevelCount> levels = {level(1, 0), level(8, 0), level(1, 4), level(1, 7), level(0, 8)};
  const auto chosen = studies::paper::initial_levels(config, levels);
  ASSERT_EQ(chosen.size(), 5U);
  EXPECT_EQ(chosen[0].level, 1U);
  EXPECT_EQ(chosen[1].level, 2U);
  EXPECT_EQ(chosen[2].level, 3U) << "put in between for the first rule";
  EXPECT_EQ(chosen[2].note(), "k = 3");
  EXPECT_EQ(chosen[3].level, 4U);
  EXPECT_EQ(chosen[3].note(), "");
  EXPECT_EQ(chosen[4].level, 5U);
  EXPECT_TRUE(chosen[4].whole);
  EXPECT_EQ(chosen[4].note(), "whole tree, k = 10, k = 1e+06");
}

TEST(Saved, IsAFractionOfTheWhole) {
  EXPECT_EQ(studies::paper::saved(55, 100), 0.45);
  EXPECT_EQ(studies::paper::saved(100, 100), 0.0);
  EXPECT_EQ(studies::paper::saved(150, 100), -0.5);
  EXPECT_EQ(studies::paper::saved(5, 0), 0.0);
}

RunOutcomes two_levels() {
  RunOutcomes run;
  run.run = {"gears:2", 2};
  const auto building = [](sim::Ticks ticks) {
    processors::cost::TimeSums time{};
    time[static_cast<std::size_t>(processors::cost::Activity::building)] = ticks;
    return time;
  };
  run.levels.push_back({{3, false, {10.0}}, 20, 1000, building(80), 4, 33, 2, 55});
  run.levels.push_back({{9, true, {3.0}}, 100, 900, building(100), 8, 65, 0, 100});
  return run;
}

TEST(BuildingTable, ComparesWithTheWholeTree) {
  const Table table = studies::paper::building_table(2, two_levels());
  EXPECT_EQ(table.name(), "table4");
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(std::get<std::int64_t>(table.at(0, "total")), 1020);
  EXPECT_EQ(std::get<double>(table.at(0, "memory_saved")), 0.45);
  EXPECT_EQ(std::get<double>(table.at(0, "building_saved")), 0.2);
  EXPECT_EQ(std::get<double>(table.at(0, "total_change")), 0.02);
  EXPECT_EQ(std::get<std::int64_t>(table.at(0, "partial")), 2);
  for (const char* column : {"memory_saved", "building_saved", "total_change"}) {
    EXPECT_EQ(std::get<double>(table.at(1, column)), 0.0) << column;
  }
}

TEST(Savings, AreThoseOfTheRulesLevel) {
  const std::vector<RunOutcomes> runs = {two_levels()};
  const Table table = studies::paper::savings_table(runs, std::vector{3.0, 10.0});
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(std::get<std::int64_t>(table.at(0, "level")), 9);
  EXPECT_EQ(std::get<double>(table.at(0, "memory_saved")), 0.0);
  EXPECT_EQ(std::get<std::int64_t>(table.at(1, "level")), 3);
  EXPECT_EQ(std::get<double>(table.at(1, "memory_saved")), 0.45);
  EXPECT_NEAR(std::get<double>(table.at(1, "render_change")), 1.0 / 9.0, 1e-15);
  EXPECT_EQ(runs[0].by_rule(4.0), nullptr);
}

}  // namespace
}  // namespace marti::tests
