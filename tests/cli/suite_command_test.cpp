// `marti study suite` as its user runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/cli/printed_json.h"
#include "tests/cli/sweep_files.h"
#include "tests/support/csv_records.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string machines = R"(
[image]
width = 16
height = 12

[energy]
preset = "22nm"

[sweep.points.few]
machine.nodes = 2

[sweep.points.many]
machine.nodes = 8
)";

const std::string scenes = R"(
[suite]
baseline = "few"

[[suite.scene]]
name = "pot"
source = "teapot:2"

[[suite.scene]]
name = "lost"
source = "lost/"
found = "the attic"

[[suite.scene]]
name = "two of them"
source = ["tri.obj", { source = "tri.obj", translate = [0, 0, 1] }]
)";

class SuiteCommand : public testing::Test {
 protected:
  SuiteCommand() {
    write(config, scenes + machines);
    write(directory.path() / "tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }
  [[nodiscard]] Outcome suite(const std::string& options = {}) const {
    return marti("study suite " + quoted(config) + " --quiet -o " + quoted(out) + " " + options);
  }
  /// What a run of its own takes.
  [[nodiscard]] double frame_time(const std::string& source, int nodes) const {
    const fs::path run = directory.path() / "run.toml";
    write(run, "scene.source = " + source + "\nmachine.nodes = " + std::to_string(nodes) + "\n" + machines);
    return printed_json("run " + quoted(run) + " --no-what-helps")
        .at("figures")
        .at("machine")
        .at("end")
        .get<double>();
  }

  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "suite.toml";
  const fs::path out = directory.path() / "out";
};

// Each speed-up is that of two runs, the mean is geometric, the scene that is not there is named, and the
// same command finds all done.
TEST_F(SuiteCommand, ComparesEachSceneAndGoesOn) {
  const Outcome first = suite();
  ASSERT_EQ(first.status, 0) << first.output;
  EXPECT_TRUE(says(first, "left out      lost: there is no " + (directory.path() / "lost/").string() +
                              "; found at the attic"));
  EXPECT_TRUE(says(first, "timed         6 machines"));
  const auto records = read_csv(read(out / "suite.csv"));
  ASSERT_TRUE(records);
  const std::vector<CsvRecord>& rows = *records;
  ASSERT_EQ(rows.size(), 4U) << read(out / "suite.csv");
  EXPECT_EQ(rows[0][0], "scene");
  EXPECT_EQ(rows[0][2], "speedup");
  const std::string two = R"(["tri.obj", { source = "tri.obj", translate = [0, 0, 1] }])";
  const double pot = frame_time("\"teapot:2\"", 2) / frame_time("\"teapot:2\"", 8);
  const double both = frame_time(two, 2) / frame_time(two, 8);
  EXPECT_EQ(rows[1][0], "pot");
  EXPECT_EQ(rows[1][1], "many");
  EXPECT_NEAR(std::stod(rows[1][2]), pot, 1e-9);
  EXPECT_EQ(rows[2][0], "two of them");
  EXPECT_NEAR(std::stod(rows[2][2]), both, 1e-9);
  EXPECT_NEAR(std::stod(rows[2][7]), frame_time(two, 8) / 1e9, 1e-9);
  EXPECT_EQ(rows[3][0], "geometric mean");
  EXPECT_NEAR(std::stod(rows[3][2]), std::sqrt(pot * both), 1e-9);
  EXPECT_NEAR(std::stod(rows[3][3]), std::sqrt(std::stod(rows[1][3]) * std::stod(rows[2][3])), 1e-9);
  EXPECT_TRUE(read(out / "suite.tex").find("geometric mean & many & ") != std::string::npos);
  EXPECT_TRUE(read(out / "report.html").find("geometric mean") != std::string::npos);
  EXPECT_TRUE(says(suite(), "all of it was there already"));
}

// Also of a scene that one could take for another by its source.
TEST_F(SuiteCommand, SaysWhichSceneIsAtFault) {
  write(directory.path() / "bad.obj", "v 0 0 zero\n");
  write(config, scenes + "\n[[suite.scene]]\nname = \"the bad one\"\nsource = \"bad.obj\"\n" + machines);
  const Outcome outcome = suite();
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(says(outcome, "suite.toml:20: suite.scene the bad one: "));
  EXPECT_TRUE(says(outcome, "bad.obj:1: 'zero' is no number (the point "));
}

TEST_F(SuiteCommand, RefusesWhatIsNoSuite) {
  const auto refusal = [&](const std::string& text) {
    write(config, text);
    const Outcome outcome = suite();
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    return outcome;
  };
  EXPECT_TRUE(says(refusal(machines), "suite: is missing"));
  EXPECT_TRUE(
      says(refusal("[suite]\nbaseline = \"none\"\n[[suite.scene]]\nname = \"a\"\nsource = \"tetra:1\"\n" +
                   machines),
           "suite.toml:2: suite.baseline: there is no other machine, or none of this name"));
  EXPECT_TRUE(says(
      refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nname = \"a\"\nsource = \"no.obj\"\n" + machines),
      "none of the suite's scenes is there"));
  EXPECT_TRUE(
      says(refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nnmae = \"a\"\nsource = \"tetra:1\"\n" +
                   machines),
           "suite.scene.nmae: unknown key (did you mean \"name\"?)"));
  EXPECT_TRUE(says(refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nname = \"a\"\nsource = "
                           "\"tri.obj\"\nsha256 = \"" +
                           std::string(64, '0') + "\"\n" + machines),
                   "tri.obj is another file: its SHA-256 is not 00000"));
  write(config, scenes + machines);
  EXPECT_TRUE(says(marti("run " + quoted(config)), "`marti study suite`"));
}

}  // namespace
}  // namespace marti::test
