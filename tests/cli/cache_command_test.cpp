// Second-level caches and what is counted when asked, from the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string counting = shipped("second-level.toml") + small_teapot;

TEST(CacheCommand, WhatIsCountedAddsUpInTheResultAndInItsTable) {
  const TemporaryDirectory directory;
  const Outcome outcome = marti("run " + counting + " -o " + quoted(directory.path() / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* line : {"second level", "compulsory", "sharing ", "where misses and waits come from",
                           "shadow rays", "attribution.csv"}) {
    EXPECT_TRUE(says(outcome, line)) << line;
  }
  const auto result = nlohmann::json::parse(read(directory.path() / "out" / "result.json"));
  const auto figure = [&](const std::string& name) {
    return result["figures"]["machine"][name].get<std::int64_t>();
  };
  const std::int64_t misses = figure("misses");
  std::int64_t classed = 0;
  for (const char* why : {"compulsory", "capacity", "conflict", "invalidation"}) {
    classed += figure("all_misses_" + std::string(why));
  }
  EXPECT_EQ(classed, misses);
  EXPECT_EQ(figure("sharing_fetches"), misses);
  const auto& counts = result["machine"]["counts"];
  std::int64_t lines = 0;
  for (const auto& bucket : counts["lines_by_nodes"]) {
    lines += bucket[1].get<std::int64_t>();
  }
  EXPECT_EQ(lines, figure("sharing_distinct_lines"));
  std::int64_t attributed = 0;
  std::int64_t waited = 0;
  for (const auto& row : counts["attribution"]) {
    attributed += row["misses"].get<std::int64_t>();
    waited += row["bank_wait_ps"].get<std::int64_t>() + row["bank_access_ps"].get<std::int64_t>();
  }
  EXPECT_EQ(attributed, misses);
  EXPECT_EQ(waited, figure("time_bank_wait") + figure("time_bank_access"));
  EXPECT_EQ(figure("l2_hits") + figure("l2_misses"), misses);
  const std::string table = read(directory.path() / "out" / "attribution.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')),
            counts["attribution"].size() + 1);
}

TEST(CacheCommand, TheWorkingSetIsThatOfTheMachineAtItsOwnSize) {
  const TemporaryDirectory directory;
  const std::string run = "run " + counting + " --set count.working_set=true --set cache.replacement=lru";
  for (const std::string organisation : {"unified", "split"}) {
    const fs::path out = directory.path() / organisation;
    const Outcome outcome = marti(run + " --set cache.organisation=" + organisation + " -o " + quoted(out));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    for (const char* line :
         {"working set ", "2 x compulsory with", "working_set.csv", "working_set.vl.json"}) {
      EXPECT_TRUE(says(outcome, line)) << line;
    }
    const auto result = nlohmann::json::parse(read(out / "result.json"));
    const auto& machine = result["machine"];
    const auto& figures = result["figures"]["machine"];
    auto misses = figures["misses"].get<std::int64_t>();
    std::int64_t compulsory = 0;
    std::size_t rows = 1;
    for (const auto& cache : machine["working_set"]["caches"]) {
      const auto& points = cache[cache["sets"] == 1 ? "fully_associative" : "ways"];
      const auto own = std::find_if(points.begin(), points.end(),
                                    [&](const auto& point) { return point[0] == cache["machine_ways"]; });
      ASSERT_NE(own, points.end());
      misses -= (*own)[1].get<std::int64_t>();
      compulsory += cache["compulsory"].get<std::int64_t>();
      EXPECT_EQ(cache["fully_associative"].back()[1], cache["compulsory"]);
      rows += cache["fully_associative"].size() + cache["ways"].size();
    }
    EXPECT_EQ(misses, 0);
    EXPECT_EQ(compulsory, figures["all_misses_compulsory"].get<std::int64_t>());
    const std::string table = read(out / "working_set.csv");
    EXPECT_GE(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), rows);
    const auto chart = nlohmann::json::parse(read(out / "working_set.vl.json"));
    EXPECT_EQ(chart["data"]["values"].size(),
              static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')) - 1);
  }
}

TEST(CacheCommand, RefusesWhatCannotBeBuiltOrCounted) {
  const auto refused = [](const std::string& options, const char* key) {
    expect_refused("run " + counting + options, key);
  };
  refused(" --set l2.ways=3 --set l2.replacement=plru", "l2.size");
  refused(" --set cache.ways=3", "cache.size");
  refused(" --set interconnect.kind=ideal", "l2.sharing");
  refused(" --set database.placement=replicated", "l2.sharing");
  refused(" --set count.working_set=true --set build.sharing=shared", "count.working_set");
  refused(" --set l2.sharing=none --set l2.ways=2", "l2.ways");
  refused(" --set count.working_set=true --set node.contexts=2", "count.working_set");
}

}  // namespace
}  // namespace marti::test
