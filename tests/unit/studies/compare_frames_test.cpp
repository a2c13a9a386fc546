// `marti compare`: times of different frames are never called a machine's effect; where the time went adds
// up; points of two sweeps find each other; the page shows all of it, whatever the names are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/config.h"
#include "studies/compare/compare.h"
#include "studies/compare/differences.h"
#include "studies/compare/figures.h"
#include "studies/compare/page.h"
#include "studies/compare/results.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/run/run_result.h"
#include "studies/show/result_json.h"
#include "studies/sweep/store/sweep_store.h"
#include "tests/support/temporary_directory.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace compare;
using namespace report;
using namespace run;
using namespace sweep;

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TemporaryDirectory;

const std::string small_scene =
    "scene.source = \"teapot:2\"\nimage.width = 16\nimage.height = 12\nmachine.nodes = 4\n";

fs::path write_run(const fs::path& directory, const std::vector<std::string>& assignments) {
  sim::Config config = sim::Config::from_text(run_schema(), small_scene, "test", assignments);
  fs::create_directories(directory);
  std::ofstream(directory / "result.json", std::ios::binary) << show::json_of(run::run(config));
  return directory;
}

json compared(const fs::path& a, const fs::path& b) {
  return json::parse(compare_results(a.string(), b.string(), {true, true}));
}

std::vector<ActivityTime> times_of(const ComparedResult& a, const ComparedResult& b) {
  ActivityTimes times;
  times.add(a, b);
  return times.means();
}

// Every tick of a node belongs to one activity, so the changes of the means add up to that of the frame time.
TEST(CompareFrames, TheTimesOfActivitiesAddUpToTheFrameTime) {
  const TemporaryDirectory directory;
  const std::vector<std::vector<std::string>> machines = {{},
                                                          {"machine.nodes=7", "cache.size=1KiB"},
                                                          {"machine.clusters=2"},
                                                          {"machine.scheme=space", "node.clock=40MHz"},
                                                          {"node.contexts=3"},
                                                          {"database.placement=distributed"}};
  std::vector<ComparedResult> results;
  for (const std::vector<std::string>& machine : machines) {
    Results run(write_run(directory.path() / std::to_string(results.size()), machine).string());
    results.push_back(run.at(run.points()[0], true));
  }
  for (const ComparedResult& a : results) {
    for (const ComparedResult& b : results) {
      const std::vector<ActivityTime> times = times_of(a, b);
      ASSERT_FALSE(times.empty());
      double change = 0.0;
      double mean = 0.0;
      double last = INFINITY;
      for (const ActivityTime& time : times) {
        EXPECT_LE(std::abs(time.change), last) << "the largest change comes first";
        last = std::abs(time.change);
        change += time.change;
        mean += time.mean_a;
        EXPECT_NEAR(time.change, time.mean_b - time.mean_a, 1.0);
      }
      EXPECT_NEAR(change, static_cast<double>(frame_time(b) - frame_time(a)), 0.01);
      EXPECT_NEAR(mean, static_cast<double>(frame_time(a)), 0.01);
    }
  }
  ComparedResult changed = results[0];
  changed.figures["time_idle"] = std::get<std::int64_t>(changed.figures["time_idle"]) + 1;
  EXPECT_TRUE(times_of(changed, results[1]).empty()) << "somebody has changed a time";
  changed.figures.erase("time_idle");
  EXPECT_TRUE(times_of(results[1], changed).empty());
}

TEST(CompareFrames, DifferentFramesAreNoEffectOfAMachine) {
  const TemporaryDirectory directory;
  const fs::path base = write_run(directory.path() / "base", {});
  const fs::path large = write_run(directory.path() / "large", {"image.width=17", "cache.size=1KiB"});
  const fs::path grid = write_run(directory.path() / "grid", {"structure.kind=grid"});
  const json other = compared(base, large);
  EXPECT_EQ(other["same_frame"], false);
  const std::string verdict = other["verdict"][0];
  EXPECT_NE(verdict.find("different frames, by image.width (16 in A, 17 in B)"), std::string::npos)
      << verdict;
  EXPECT_NE(verdict.find("say nothing about the machines"), std::string::npos) << verdict;
  EXPECT_TRUE(other["times"].empty());
  const std::string text = compare_results(base.string(), large.string());
  EXPECT_EQ(text.find("faster"), std::string::npos) << text;
  EXPECT_EQ(text.find("slower"), std::string::npos) << text;
  EXPECT_EQ(compared(base, grid)["same_frame"], true) << "another tree gives the same rays and pixels";
}

TEST(CompareFrames, SettingsAreTyped) {
  const TemporaryDirectory directory;
  const fs::path a = write_run(directory.path() / "a", {});
  const fs::path b = write_run(directory.path() / "b", {"cache.size=1KiB", "node.clock=40MHz",
                                                        "prefetch.next_line=true", "packets.order=morton"});
  std::map<std::string, std::pair<json, json>> found;
  const json comparison = compared(a, b);
  for (const json& setting : comparison["settings"]) {
    found[setting["name"]] = {setting["a"], setting["b"]};
  }
  EXPECT_EQ(found.at("cache.size"), std::pair(json(16384), json(1024)));
  EXPECT_EQ(found.at("node.clock").second, json(40e6));
  EXPECT_EQ(found.at("prefetch.next_line"), std::pair(json(false), json(true)));
  EXPECT_EQ(found.at("packets.order").second, json("morton"));
}

// Points of two frames: even machines render the frame of the result, odd ones another, of other pixels or of
// another scene with equal pixels and hits.
fs::path write_two_frames(const fs::path& directory, std::size_t machines, bool other_pixels = true) {
  const auto row_of = [](std::size_t machine) {
    SweepRow row = test::plain_row(machine);
    row.counters[0] = static_cast<std::int64_t>(1000 + 37 * machine % 5);
    return row;
  };
  test::write_store(directory / "results.sqlite", test::made_plan(machines), row_of, [&](std::size_t frame) {
    FrameRow row = test::made_frame_row(frame);
    const std::string hash = frame == 0 ? "00000000000000aa" : "00000000000000bb";
    row.image_hash = other_pixels ? hash : "00000000000000cc";
    row.hit_hash = "00000000000000dd";
    row.scene_hash = other_pixels ? "00000000000000ee" : hash;
    return row;
  });
  return directory;
}

class OtherFrames : public testing::TestWithParam<bool> {};

TEST_P(OtherFrames, TheirPointsComeLastWithoutARatio) {
  const TemporaryDirectory directory;
  const std::string sweep = write_two_frames(directory.path() / "sweep", 9, GetParam()).string();
  EXPECT_EQ(compared(sweep + ":2", sweep + ":3")["same_frame"], false);
  EXPECT_EQ(compared(sweep + ":2", sweep + ":4")["same_frame"], true);
  for (const std::int64_t ordinal : {2, 3}) {
    const json found = compared(sweep + ":" + std::to_string(ordinal), sweep);
    EXPECT_EQ(found["same_frame"], true);
    const std::size_t same = ordinal % 2 == 0 ? 5 : 4;
    ASSERT_EQ(found["points"].size(), 9U);
    for (std::size_t i = 0; i < 9; ++i) {
      const json& point = found["points"][i];
      EXPECT_EQ(point["ratio"].is_null(), i >= same);
      EXPECT_EQ(point["point"].get<std::int64_t>() % 2 == ordinal % 2, i < same);
    }
    EXPECT_EQ(found["points_of_other_frames"], 9 - same);
    EXPECT_EQ(found["timed_points"], 9);
    EXPECT_EQ(found["nearest_point"], ordinal) << "a machine is nearest to itself";
    ASSERT_EQ(found["frame_settings"].size(), 1U);
    EXPECT_EQ(found["frame_settings"][0]["name"], "scene.source");
  }
}

INSTANTIATE_TEST_SUITE_P(ByPixelsOrByScene, OtherFrames, testing::Bool());

TEST(CompareFrames, ASweepOfAnotherFrameHasNoFasterPoint) {
  const TemporaryDirectory directory;
  const std::string sweep = write_two_frames(directory.path() / "sweep", 6).string();
  const fs::path run = write_run(directory.path() / "run", {});
  for (const bool sweep_is_a : {false, true}) {
    const std::string a = sweep_is_a ? sweep : run.string();
    const std::string b = sweep_is_a ? run.string() : sweep;
    const json found = compared(a, b);
    EXPECT_EQ(found["same_frame"], false);
    ASSERT_EQ(found["points"].size(), 6U);
    for (const json& point : found["points"]) {
      EXPECT_TRUE(point["ratio"].is_null());
    }
    EXPECT_EQ(found["points"][0]["point"], found["nearest_point"]);
    const std::string text = compare_results(a, b);
    EXPECT_LT(text.find("frame          "), text.find("configuration")) << text;
    EXPECT_EQ(text.find("faster"), std::string::npos) << text;
    EXPECT_EQ(text.find("B / A"), std::string::npos) << text;
  }
}

// The nearest point by a second, naive way.
TEST(CompareFrames, TheNearestPointDiffersInTheFewestSettings) {
  const TemporaryDirectory directory;
  const std::string sweep = write_two_frames(directory.path() / "sweep", 8).string();
  const json found = compared(sweep + ":0", sweep);
  std::map<std::size_t, std::int64_t> by_distance;
  for (std::int64_t ordinal = 0; ordinal < 8; ordinal += 2) {
    const json pair = compared(sweep + ":0", sweep + ":" + std::to_string(ordinal));
    std::size_t distance = 0;
    for (const json& setting : pair["settings"]) {
      distance += !setting["a"].is_null() && !setting["b"].is_null() ? 1 : 0;
    }
    by_distance.emplace(distance, ordinal);
  }
  EXPECT_EQ(found["nearest_point"], by_distance.begin()->second);
}

// Two sweeps whose machines have other settings alike are joined by the values of their axes.
TEST(CompareFrames, SweepsWithTheSameAxesAreJoinedByThem) {
  const TemporaryDirectory directory;
  const auto fill = [&](const char* name, std::size_t machines, std::int64_t factor, const char* packets) {
    SweepPlan plan = test::made_plan(machines);
    SettingsPool pool;
    for (SweepMachine& machine : plan.machines) {
      std::vector<sim::EffectiveValue> settings;
      for (const SettingsPart& part : machine.settings) {
        settings.insert(settings.end(), part->begin(), part->end());
      }
      settings.push_back({"packets.width", packets, false, ""});
      machine.settings = pool.share(std::move(settings));
    }
    test::write_store(directory.path() / name / "results.sqlite", plan, [&](std::size_t machine) {
      SweepRow row = test::plain_row(machine);
      row.counters[0] = factor * (1000 + static_cast<std::int64_t>(machine));
      return row;
    });
    return directory.path() / name;
  };
  const fs::path a = fill("a", 6, 1, "8");
  const fs::path b = fill("b", 4, 3, "4");
  const json found = compared(a, b);
  EXPECT_EQ(found["joined_by"], "axes");
  EXPECT_EQ(found["timed_in_both"], 4);
  EXPECT_EQ(found["points_only_in_a"], json({4, 5}));
  ASSERT_EQ(found["points"].size(), 4U);
  for (const json& point : found["points"]) {
    EXPECT_EQ(point["point_a"], point["point_b"]);
    EXPECT_EQ(point["ratio"], 3.0);
    EXPECT_TRUE(point["settings"].empty());
  }
  EXPECT_NEAR(found["mean_ratio"].get<double>(), 3.0, 1e-12);
  ASSERT_EQ(found["settings"].size(), 1U);
  EXPECT_EQ(found["settings"][0]["name"], "packets.width");
  EXPECT_EQ(found["settings"][0]["b"], 4);
}

// Where the time of two sweeps went: the changes of all activities are that of the frame times.
TEST(CompareFrames, TheTimesOfTwoSweepsAddUp) {
  const TemporaryDirectory directory;
  const auto fill = [&](const char* name, const std::vector<std::string>& more) {
    SweepPlan plan;
    SettingsPool pool;
    std::vector<RunResult> runs;
    for (const char* nodes : {"1", "3", "8"}) {
      std::vector<std::string> assignments = more;
      assignments.push_back(std::string("machine.nodes=") + nodes);
      sim::Config config = sim::Config::from_text(run_schema(), small_scene, "test", assignments);
      runs.push_back(run::run(config));
      const std::size_t i = plan.machines.size();
      plan.machines.push_back({test::made_key(i), 0, i, runs[i].machine, pool.share(runs[i].values)});
      plan.points.push_back({{static_cast<std::int64_t>(std::stoi(nodes))}, i, 0, 1.0});
    }
    plan.axes = {"machine.nodes"};
    plan.frames.push_back({test::made_key(100), runs[0].frame_config, {}});
    test::write_store(
        directory.path() / name / "results.sqlite", plan,
        [&](std::size_t i) { return sweep_row(runs[i].machine, runs[i].timed); },
        [&](std::size_t) { return frame_row(runs[0].functional, 0); });
    return directory.path() / name;
  };
  const json found = compared(fill("a", {}), fill("b", {"cache.size=512B", "node.clock=50MHz"}));
  ASSERT_EQ(found["points"].size(), 3U);
  double expected = 0.0;
  for (const json& point : found["points"]) {
    expected += (point["ratio"].get<double>() - 1.0) / 3.0;
  }
  double sum = 0.0;
  for (const json& time : found["times"]) {
    sum += time["change_of_frame"].get<double>();
  }
  EXPECT_NEAR(sum, expected, 1e-9);
  EXPECT_NE(expected, 0.0);
}

std::string page_of_files(const fs::path& a, const fs::path& b) {
  ComparisonPage page;
  (void)compare_results(a.string(), b.string(), {}, &page);
  return html_of(page);
}

TEST(CompareFrames, PagesEscapeWhatTheyShow) {
  if (!have_vega_scripts()) {
    GTEST_SKIP() << "built without the scripts of pages";
  }
  const TemporaryDirectory directory;
  const fs::path a = write_run(directory.path() / "<img src=x onerror=alert(1)>", {});
  const fs::path b = write_run(directory.path() / "b", {"cache.size=1KiB"});
  // A hostile result: names and values that would end an element, a script or a line.
  json hostile = json::parse(std::ifstream(b / "result.json"));
  hostile["config"]["keys"]["x\"><script>alert(1)</script>"] = {{"value", "</script><b>\x1b[1m"},
                                                                {"given", true}};
  hostile["figures"]["machine"]["<i>figure</i>"] = 3;
  hostile["figures"]["frame"]["scene"] = "</title><script>alert(2)</script>";
  hostile["machine"]["what_helps"]["sentence"] = "<script>alert(3)</script>";
  std::ofstream(b / "result.json") << hostile.dump();
  const std::string page = page_of_files(a, b);
  EXPECT_EQ(page.find("<img src=x"), std::string::npos);
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<i>"), std::string::npos);
  EXPECT_EQ(page.find('\x1b'), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;alert(3)"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page, page_of_files(a, b)) << "equal files give equal bytes";
}

TEST(CompareFrames, PagesShowSizesAsPeopleWriteThem) {
  if (!have_vega_scripts()) {
    GTEST_SKIP() << "built without the scripts of pages";
  }
  const TemporaryDirectory directory;
  const fs::path a = write_run(directory.path() / "a", {});
  const fs::path b = write_run(directory.path() / "b", {"cache.size=1KiB"});
  const std::string page = page_of_files(a, b);
  EXPECT_NE(page.find("<td data-number=\"16384\">16 KiB</td><td data-number=\"1024\">1 KiB</td>"),
            std::string::npos);
  std::size_t last = 0;
  for (const char* part : {"id=\"answer\"", "id=\"machine\"", "id=\"time\"", "id=\"counters\""}) {
    const std::size_t at = page.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    EXPECT_GT(at, last) << part;
    last = at;
  }
  const std::string sweep = write_two_frames(directory.path() / "sweep", 5).string();
  EXPECT_NE(page_of_files(sweep, sweep).find("chart-compare_points"), std::string::npos);
  EXPECT_NE(page_of_files(sweep + ":0", sweep).find("chart-compare_points"), std::string::npos);
  EXPECT_EQ(page_of_files(a, sweep).find("id=\"chart-compare_points\""), std::string::npos)
      << "frames differ: there is no ratio to draw";
}

}  // namespace
}  // namespace marti::studies
