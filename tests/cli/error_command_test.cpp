// `marti study error` and `marti run --within` as their user meets them.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/printed_json.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

// The shipped study with a scene that takes no time.
const std::string small_errors =
    shipped("error.toml") +
    " --set scene.source=gears:1 --set image.width=64 --set image.height=48 --set image.samples=2 --set "
    "error.within=[0.1] --set error.divisors=[4] --set error.side=12 --set error.samples=[1,2,4] --set "
    "error.depths=[1,2] --set error.repeats=2";

TEST(StudyError, AnswersFirstAndWritesOnePicture) {
  const TemporaryDirectory directory;
  EXPECT_GE(
      expect_study("error " + small_errors, directory.path(),
                   {"Frame time, in ", "Image by samples, in ", "The error of samples goes as samples^p",
                    "by an exact run", "smaller image", "fewer samples", "voxel cut", "results.sqlite"},
                   {"host_error.csv", "host_error.vl.json", "host_error_answer.csv"}),
      2);
  // The page begins with the study's answer.
  const fs::path page = directory.path() / "page.html";
  ASSERT_EQ(marti("report " + quoted(directory.path() / "a") + " -o " + quoted(page)).status, 0);
  EXPECT_NE(read(page).find("Frame time, in "), std::string::npos);
}

TEST(StudyError, WrongInputIsTwo) {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("study error " + small_errors + " -o " + quoted(directory.path() / "out") + options,
                   complaint);
  };
  refused(" --set error.repeats=0", "error.repeats");
  refused(" --set error.samples=[0]", "error.samples");
  refused(" --set error.within=[0.0]", "error.within");
  refused(" --set error.divisors=[1]", "error.divisors");
  refused(" --set image.voxel_cut=2", "error.voxel_cuts");
  refused(" --set error.scene=x", "error.s");
}

const std::string machine =
    shipped("marti.toml") +
    " --set scene.source=teapot:2 --set image.width=448 --set image.height=448 --no-what-helps ";

TEST(RunWithin, GivesAnEstimateWithErrorBarsOrAnExactRun) {
  const Outcome wide = marti("run " + machine + "--within '60 %'");
  ASSERT_EQ(wide.status, 0) << wide.output;
  for (const char* text : {"left out ", "windows", "estimate ", "not exact", "+- ", "frame time", "speed-up",
                           "misses", "mean wait"}) {
    EXPECT_TRUE(says(wide, text)) << text;
  }
  EXPECT_FALSE(says(wide, "bounds "));
  EXPECT_EQ(
      marti("run " + machine + "--within 0.6").output.find("asked for within 60 %") == std::string::npos,
      false);
  const Outcome none = marti("run " + machine + "--within 0%");
  ASSERT_EQ(none.status, 0) << none.output;
  EXPECT_TRUE(says(none, "exact replay, no error"));
  // Except for the reason, the output equals that without --within.
  const std::string plain = marti("run " + machine).output;
  EXPECT_EQ(none.output.substr(0, plain.size()), plain);
  const Outcome outside = marti("run " + machine + "--within 5% --set machine.scheme=space");
  EXPECT_EQ(outside.status, 0) << outside.output;
  EXPECT_TRUE(says(outside, "exact replay, no error: "));
}

TEST(RunWithin, GivesTheSameToPrograms) {
  const nlohmann::json json = printed_json("run " + machine + "--within 60%");
  const auto& estimate = json["estimate"];
  EXPECT_EQ(estimate["tolerance"], 0.6);
  EXPECT_EQ(json["config"]["keys"]["image.width"]["value"], 448);
  EXPECT_FALSE(estimate["one_node"].contains("speed_up"));
  for (const char* figure : {"end", "speed_up", "misses", "use", "wait"}) {
    const auto& bar = estimate["machine"][figure];
    EXPECT_EQ(bar["low"].is_null(), bar["half_width"].is_null()) << figure;
    EXPECT_TRUE(bar["low"].is_null() || (bar["low"] <= bar["value"] && bar["half_width"] >= 0.0)) << figure;
    EXPECT_TRUE(bar["high"].is_null() || bar["high"] >= bar["value"]) << figure;
  }
  EXPECT_LE(estimate["machine"]["end"]["half_width"], 0.6);
  // The speed-up is the ratio of the two times.
  const double ratio =
      estimate["one_node"]["end"]["value"].get<double>() / estimate["machine"]["end"]["value"].get<double>();
  EXPECT_NEAR(estimate["machine"]["speed_up"]["value"].get<double>(), ratio, 1e-9 * ratio);
  EXPECT_EQ(marti("run " + machine + "--within 0% --json").output, marti("run " + machine + "--json").output)
      << "an exact run's result is that of any exact run";
}

TEST(RunWithin, WrongInputIsTwo) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("run " + machine + options, complaint);
  };
  refused("--within ''", "percentage");
  refused("--within 2", "tolerance");
  refused("--within 101%", "tolerance");
  refused("--within -3%", "--within");
  refused("--within few", "tolerance");
  refused("--within 2% -o " + quoted(out), "--within");
  EXPECT_FALSE(fs::exists(out));
  refused("--within 2% --set machine.nodes=0", "machine.nodes");
  refused("--within 2% --set record.timeline=true", "record.timeline");
}

}  // namespace
}  // namespace marti::test
