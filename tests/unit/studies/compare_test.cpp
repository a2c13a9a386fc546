// `marti compare`: a run and the same machine in a sweep's store have equal figures, and it finds all
// made-up differences.
#include "studies/compare/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/config.h"
#include "sim/error.h"
#include "studies/compare/differences.h"
#include "studies/run/run_result.h"
#include "studies/show/result_json.h"
#include "studies/sweep/store/point_result.h"
#include "studies/sweep/store/sweep_store.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace compare;
using namespace figures;
using namespace run;
using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TemporaryDirectory;
using test::user_error_of;

RunResult run_of(const std::vector<std::string>& assignments) {
  sim::Config config = sim::Config::from_text(
      run_schema(), "scene.source = \"teapot:2\"\nimage.width = 16\nimage.height = 12\nmachine.nodes = 4\n",
      "test", assignments);
  return run::run(config);
}

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

// The run as the only point of a sweep.
void write_sweep(const fs::path& file, const RunResult& run) {
  SweepPlan plan;
  plan.frames.push_back({test::made_key(1), run.frame_config, {}});
  plan.machines.push_back({test::made_key(2), 0, 0, run.machine, SettingsPool().share(run.values)});
  plan.points.push_back({{}, 0, 0, 1.0});
  test::write_store(
      file, plan, [&](std::size_t) { return sweep_row(run.machine, run.timed); },
      [&](std::size_t) { return frame_row(run.functional, 0); });
}

class ComparedMachines : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(ComparedMachines, AreEqualInARunAndInASweep) {
  const TemporaryDirectory directory;
  const RunResult run = run_of(GetParam());
  write(directory.path() / "run" / "result.json", show::json_of(run));
  write_sweep(directory.path() / "sweep" / "results.sqlite", run);
  const std::string a = (directory.path() / "run").string();
  const std::string b = (directory.path() / "sweep").string() + ":0";
  const json found = json::parse(compare_results(a, b, {true, true}));
  EXPECT_TRUE(found["numbers"].empty()) << found["numbers"].dump(1);
  EXPECT_TRUE(found["texts"].empty()) << found["texts"].dump(1);
  EXPECT_TRUE(found["settings"].empty()) << found["settings"].dump(1);
  // All counted figures are compared, and the scene's name and two hashes.
  std::size_t there = 0;
  for (const auto& counter : sweep_row(run.machine, run.timed).counters) {
    there += counter ? 1 : 0;
  }
  for (const auto& counter : frame_row(run.functional, 0).counters) {
    there += counter ? 1 : 0;
  }
  EXPECT_GE(found["equal_figures"].get<std::size_t>(), there + 3);
  EXPECT_TRUE(found["one_side"].empty()) << found["one_side"].dump(1);
  EXPECT_EQ(json::parse(compare_results(b, a, {true, true}))["equal"].size(), found["equal"].size());
}

INSTANTIATE_TEST_SUITE_P(
    Machines, ComparedMachines,
    testing::Values(std::vector<std::string>{},
                    std::vector<std::string>{"machine.clusters=2", "build.sharing=shared"},
                    std::vector<std::string>{"count.miss_classes=true", "count.sharing=true",
                                             "count.attribution=true", "l2.sharing=shared"},
                    std::vector<std::string>{"database.placement=distributed"},
                    std::vector<std::string>{"node.contexts=2"},
                    std::vector<std::string>{"machine.scheme=space"}));

TEST(Compare, FindsEveryDifferenceTheLargestFirst) {
  ComparedResult a;
  ComparedResult b;
  a.settings = {{"cache.size", "1"}, {"machine.nodes", "4"}, {"only.a", "x"}};
  b.settings = {{"cache.size", "2"}, {"machine.nodes", "4"}};
  a.figures = {{"small", std::int64_t{1000}},
               {"large", std::int64_t{10}},
               {"zero", std::int64_t{0}},
               {"same", 1.5},
               {"hash", "one"},
               {"gone", std::int64_t{1}},
               {"kind", std::int64_t{2}}};
  b.figures = {{"small", std::int64_t{1001}},
               {"large", std::int64_t{1}},
               {"zero", std::int64_t{7}},
               {"same", 1.5},
               {"hash", "two"},
               {"kind", 2.0}};
  const Differences found = differences_of(a, b);
  EXPECT_EQ(found.settings.size(), 2U);
  std::vector<std::pair<std::string, std::string>> changes;
  for (const Difference& figure : found.figures) {
    changes.emplace_back(figure.name, change_of(figure));
  }
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"hash", ""}, {"zero", "from 0"}, {"large", "-90.00 %"}, {"small", "+0.10 %"}, {"gone", ""}};
  EXPECT_EQ(changes, expected) << "texts, numbers, and what only one has";
  EXPECT_EQ(found.equal.size(), 2U) << "2 and 2.0 are the same";
}

TEST(Compare, SweepsAreMatchedBySettings) {
  const TemporaryDirectory directory;
  const fs::path a = directory.path() / "a" / "results.sqlite";
  const fs::path b = directory.path() / "b" / "results.sqlite";
  const auto fill = [](const fs::path& file, std::size_t first, bool changed) {
    test::write_store(file, test::made_plan(8, first), [&](std::size_t i) -> std::optional<SweepRow> {
      SweepRow row = test::made_row(first + i);
      if (changed && first + i == 6) {
        row.counters[0] = 2 * *row.counters[0];
      }
      return i < 7 ? std::optional(row) : std::nullopt;
    });
  };
  fill(a, 0, false);
  fill(b, 4, true);
  const auto compared = [&](const fs::path& x, const fs::path& y) {
    return json::parse(compare_results(x.parent_path().string(), y.parent_path().string(), {true, false}));
  };
  const json same = compared(a, a);
  EXPECT_EQ(same["timed_in_both"], 7);
  EXPECT_EQ(same["equal_machines"], 7);
  EXPECT_TRUE(same["counters"].empty());
  const json found = compared(a, b);
  EXPECT_EQ(found["machines_in_both"], 4);
  EXPECT_EQ(found["timed_in_both"], 3) << "machine 7 is not done in a";
  EXPECT_EQ(found["equal_machines"], 2);
  EXPECT_EQ(found["points_only_in_a"], json({0, 1, 2, 3}));
  EXPECT_EQ(found["points_only_in_b"], json({4, 5, 6, 7}));
  ASSERT_EQ(found["counters"].size(), 1U);
  EXPECT_EQ(found["counters"][0]["name"], "end");
  EXPECT_EQ(found["counters"][0]["relative"], 0.5);
  EXPECT_EQ(found["counters"][0]["point_a"], 6);
  EXPECT_EQ(found["counters"][0]["point_b"], 2);
  const std::string text = compare_results(a.string(), b.string());
  EXPECT_NE(text.find("+100.00 %"), std::string::npos) << text;
}

TEST(Compare, PointsWithinTheNoiseAreCounted) {
  const TemporaryDirectory directory;
  const fs::path a = directory.path() / "a" / "results.sqlite";
  const fs::path b = directory.path() / "b" / "results.sqlite";
  test::write_store_of_seeds(a, {1000, 1020, 1010, 500, 500, 500});
  test::write_store_of_seeds(b, {1010, 1020, 1000, 500, 505, 520});
  const json found = json::parse(compare_results(a.string(), b.string(), {true, false}));
  EXPECT_NEAR(found["noise"].get<double>(), 0.04, 1e-12);
  EXPECT_EQ(found["points_within_noise"], 4) << "two are equal";
  EXPECT_NE(
      compare_results(a.string(), b.string())
          .find("At 4 of these points the difference is no more than another seed of the image does, up "
                "to 4.00 %: it does not say which machine is faster there."),
      std::string::npos);
  const json changed =
      json::parse(compare_results((a.parent_path()).string() + ":0", b.string(), {true, false}));
  EXPECT_GT(changed["points_within_noise"], 0);
}

// Settings by name as A and B have them.
std::map<std::string, std::pair<json, json>> settings_of(const json& list) {
  std::map<std::string, std::pair<json, json>> settings;
  for (const json& setting : list) {
    EXPECT_TRUE(settings.emplace(setting["name"], std::pair(setting["a"], setting["b"])).second);
  }
  return settings;
}

// The oracle for what differs alike in every point: the result compared with each point by itself.
void expect_comparison_of_each_point(const std::string& result, const std::string& sweep, std::size_t planned,
                                     const std::vector<std::int64_t>& timed, bool same_frame) {
  for (const bool sweep_is_a : {false, true}) {
    const auto compared = [&](const std::string& with) {
      return json::parse(sweep_is_a ? compare_results(with, result, {true, true})
                                    : compare_results(result, with, {true, true}));
    };
    const json found = compared(sweep);
    EXPECT_EQ(found["sweep"], sweep_is_a ? "a" : "b");
    EXPECT_EQ(found["planned_points"], planned);
    EXPECT_EQ(found["same_frame"], same_frame);
    ASSERT_EQ(found["points"].size(), timed.size());
    std::set<std::int64_t> seen;
    std::int64_t last = 0;
    std::map<std::string, std::set<std::string>> in_points;
    for (const json& point : found["points"]) {
      const auto ordinal = point["point"].get<std::int64_t>();
      seen.insert(ordinal);
      if (same_frame) {
        EXPECT_GE(point["end"].get<std::int64_t>(), last) << "the shortest frame comes first";
      }
      last = point["end"];
      const json pair = compared(sweep + ":" + std::to_string(ordinal));
      const double ratio = point["end_b"].get<double>() / point["end_a"].get<double>();
      EXPECT_EQ(point["ratio"], same_frame ? json(ratio) : json());
      auto expected = settings_of(found["settings"]);
      for (const auto& [name, values] : settings_of(point["settings"])) {
        EXPECT_TRUE(expected.emplace(name, values).second) << name << " is said to be alike in every point";
        in_points[name].insert(values.first.dump() + values.second.dump());
      }
      EXPECT_EQ(settings_of(pair["settings"]), expected) << ordinal;
    }
    EXPECT_EQ(seen, std::set<std::int64_t>(timed.begin(), timed.end()));
    for (const auto& [name, values] : in_points) {
      const auto here = static_cast<std::size_t>(
          std::count_if(found["points"].begin(), found["points"].end(),
                        [&](const json& point) { return settings_of(point["settings"]).contains(name); }));
      EXPECT_TRUE(values.size() > 1 || here < timed.size()) << name << " is alike in every point";
    }
  }
}

TEST(Compare, AResultWithASweepIsItsComparisonWithEachPoint) {
  const TemporaryDirectory directory;
  const std::string sweep = (directory.path() / "sweep").string();
  SweepPlan plan = test::made_plan(12);
  // Two points of one machine.
  plan.points[7].machine = plan.points[4].machine;
  test::write_store(fs::path(sweep) / "results.sqlite", plan, [](std::size_t machine) {
    // Some frame times are equal.
    SweepRow row = test::plain_row(machine);
    row.counters[0] = static_cast<std::int64_t>(1000 + 37 * machine % 5);
    return machine % 4 != 1 ? std::optional(row) : std::nullopt;
  });
  std::vector<std::int64_t> timed;
  for (std::size_t point = 0; point < 12; ++point) {
    if (plan.points[point].machine % 4 != 1) {
      timed.push_back(static_cast<std::int64_t>(point));
    }
  }
  expect_comparison_of_each_point(sweep + ":2", sweep, 12, timed, true);
  const fs::path run = directory.path() / "run" / "result.json";
  write(run, show::json_of(run_of({"machine.nodes=2"})));
  expect_comparison_of_each_point(run.string(), sweep, 12, timed, false);

  const std::string text = compare_results(sweep + ":2", sweep);
  std::int64_t faster = 0;
  std::int64_t equal = 0;
  const json found = json::parse(compare_results(sweep + ":2", sweep, {true, false}));
  for (const json& point : found["points"]) {
    faster += point["end"] < found["end"] ? 1 : 0;
    equal += point["end"] == found["end"] ? 1 : 0;
  }
  EXPECT_NE(text.find("Of 9 points, B is faster at " + std::to_string(faster) + ", as fast as A at " +
                      std::to_string(equal) + " and slower at " + std::to_string(9 - faster - equal)),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("B gains most at point " + found["points"][0]["point"].dump() + " of B ("),
            std::string::npos)
      << text;
  EXPECT_EQ(text, compare_results(sweep + ":2", sweep + "/results.sqlite"));
}

TEST(Compare, RefusesASweepOrAResultWithoutFrameTimes) {
  const TemporaryDirectory directory;
  const fs::path store = directory.path() / "sweep" / "results.sqlite";
  fs::create_directories(store.parent_path());
  SweepStore(store, test::made_plan(3)).close();
  const std::string run = (directory.path() / "run" / "result.json").string();
  const std::string good = show::json_of(run_of({}));
  const auto message = [&] { return user_error_of([&] { (void)compare_results(run, store.string()); }); };
  write(run, good);
  EXPECT_NE(message().find("no point of this sweep has been run yet"), std::string::npos) << message();
  fs::remove(store);
  test::write_store(store, test::made_plan(3), [](std::size_t machine) { return test::plain_row(machine); });
  for (const char* end : {"\"end\": 0", "\"end\": -5", "\"end\": \"1\"", "\"end\": null", "\"end\": 1e300",
                          "\"end\": 18446744073709551615", "\"other\": 7"}) {
    std::string changed = good;
    const std::size_t at = changed.find("\"end\": ", changed.find("\"machine\": {"));
    changed.replace(at, changed.find(',', at) - at, end);
    write(run, changed);
    EXPECT_NE(message().find(run + ": has no frame time"), std::string::npos) << end << message();
  }
}

// A point is made by `marti sweep`: that is what has to be run again.
TEST(Compare, ABrokenPointIsOfASweep) {
  const TemporaryDirectory directory;
  const fs::path store = directory.path() / "sweep" / "results.sqlite";
  test::write_store(store, test::made_plan(2), [](std::size_t /*machine*/) {
    return SweepRow{Counts(counted_figures().size()), {}};
  });
  const SweepReader reader(store);
  const RunJson point = point_result(reader, 0, "sweep:0");
  EXPECT_EQ(point.part("figures.machine").file(), "sweep:0");
  for (const RunJson& part : {point, point.part("config"), point.of(point.json()["figures"])}) {
    const std::string message = user_error_of([&] { (void)part.required_number("no.such.figure", 1, 2); });
    EXPECT_TRUE(message.starts_with("sweep:0: has no number")) << message;
    EXPECT_NE(message.find("`marti sweep CONFIG -o DIR`"), std::string::npos) << message;
    EXPECT_EQ(message.find("marti run"), std::string::npos) << message;
  }
}

TEST(Compare, RefusesWhatIsNoResult) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "result.json";
  const std::string good = show::json_of(run_of({}));
  const auto refused = [&](const std::string& text, const char* reason) {
    write(file, text);
    const std::string message = user_error_of([&] { (void)compare_results(file.string(), file.string()); });
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with(file.string())) << message;
  };
  refused("", "is not JSON");
  refused(good.substr(0, good.size() / 2), "is not JSON");
  refused("[1, 2]", "is no JSON object");
  refused("{}", "marti");
  refused("{\"marti\": {\"schema\": 3, \"version\": \"9\"}}", "schema 3");
  refused("{\"marti\": {\"schema\": \"1\"}}", "marti.schema");
  refused("{\"marti\": {\"schema\": 4}}", "config");
  refused("{\"marti\": {\"schema\": 4}, \"config\": {\"keys\": {\"a.b\": 3}}}", "config.keys.a.b");
  refused("{\"marti\": {\"schema\": 4}, \"config\": {\"keys\": {}}}", "figures.frame");
  const std::string begin =
      "{\"marti\": {\"schema\": 4}, \"config\": {\"keys\": {}}, \"figures\": {\"frame\": {}, "
      "\"machine\": {";
  std::string deep;
  for (int i = 0; i < 100; ++i) {
    deep += "{\"a\": ";
  }
  refused(begin + "\"a\": " + deep + "1" + std::string(100, '}') + "}}}", "nested too deeply");
  write(file,
        begin + "\"l\": [{\"x\": 18446744073709551615}, [], null, true], \"\\u0007\": \"\\u001b[1m\"}}}");
  EXPECT_NO_THROW((void)compare_results(file.string(), file.string(), {false, true}));
  EXPECT_EQ(compare_results(file.string(), file.string(), {false, true}).find('\x1b'), std::string::npos);
}

TEST(Compare, SaysWhatItExpects) {
  const TemporaryDirectory directory;
  const std::string place = directory.path().string();
  const auto message = [&](const std::string& a, const std::string& b) {
    return user_error_of([&] { (void)compare_results(a, b); });
  };
  EXPECT_NE(message(place + "/none", place).find("no such file"), std::string::npos);
  EXPECT_NE(message(place, place).find("neither result.json nor results.sqlite"), std::string::npos);
  const RunResult run = run_of({});
  write_sweep(directory.path() / "sweep" / "results.sqlite", run);
  write(directory.path() / "run" / "result.json", show::json_of(run));
  EXPECT_NE(message(place + "/sweep:1", place + "/run").find("no such point; the sweep has 1"),
            std::string::npos);
  EXPECT_NE(message(place + "/sweep:-1", place + "/run").find("no such point"), std::string::npos);
  EXPECT_NE(message(place + "/run:0", place + "/run").find("no such file"), std::string::npos);
  write(directory.path() / "run" / "results.sqlite", "");
  EXPECT_NE(message(place + "/run", place + "/run").find("holds both a run"), std::string::npos);
  EXPECT_EQ(message(place + "/run/result.json", place + "/sweep:0"), "no UserError");
}

}  // namespace
}  // namespace marti::studies
