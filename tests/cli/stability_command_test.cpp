// `marti study stability` as its user meets it: exit status, table, files, refusals.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

TEST(StabilityCommand, PrintsAndWritesItsTables) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const Outcome outcome = marti(
      "study stability " + quoted(fs::path(MARTI_SOURCE) / "configs" / "dram.toml") +
      " --set scene.source=tetra:3 --set stability.rays=100 --set stability.nodes=64 -o " + quoted(out));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* text :
       {"Extremes of tetra:3", "cracks", "end-of-time", "Floats beside doubles", " 0 failed"}) {
    EXPECT_TRUE(says(outcome, text)) << text;
  }
  for (const char* name :
       {"stability.csv", "float_double.csv", "columns.csv", "report.txt", "results.sqlite"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  const std::string csv = read(out / "stability.csv");
  EXPECT_EQ(csv.find("group,case,what_could_go_wrong,oracle,figure,objection,verdict"), 0U) << csv;
  // A float's spacing a million sizes away is a sixteenth of the scene: it keeps no triangle's edge apart.
  const std::string places = read(out / "float_double.csv");
  for (const char* row : {"0.0,33554432.0,64,0,0,0,", "1e+06,16.0,64,0,64,0,"}) {
    EXPECT_NE(places.find(row), std::string::npos) << row << " in\n" << places;
  }
}

TEST(StabilityCommand, RefusesWhatHasNoEffectOrIsOutOfRange) {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    const fs::path out = directory.path() / "none";
    expect_refused("study stability -o " + quoted(out) + options, complaint);
    EXPECT_FALSE(fs::exists(out / "stability.csv"));
  };
  refused(" --set machine.nodes=0", "machine.nodes");
  refused(" --set interconnect.kind=ideal --set interconnect.width=4", "interconnect.width");
  refused(" --set frames.count=2", "frames.count");
  refused(" --set 'stability.only=[\"crack\"]'", "did you mean \"cracks\"");
  refused(" --set stability.rays=0", "stability.rays");
  refused(" --set stability.nodes=4000000000", "stability.nodes");
}

// Nodes without references divide 0 by 0.
TEST(ManyIdleNodes, NothingIsPrintedThatIsNoNumber) {
  const std::string run = "run " + quoted(fs::path(MARTI_SOURCE) / "configs" / "marti.toml") +
                          " --set scene.source=tetra:1 --set image.width=16 --set image.height=12"
                          " --set machine.nodes=4096 --set packets.width=4 --set packets.height=4";
  for (const char* const form : {"", " --json"}) {
    const Outcome outcome = marti(run + form);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    for (const char* word : {" nan", "-nan", ":nan", "(nan", "nan%", " inf ", "-inf", ":inf"}) {
      EXPECT_FALSE(says(outcome, word)) << word << " in\n" << outcome.output;
    }
  }
}

}  // namespace
}  // namespace marti::test
