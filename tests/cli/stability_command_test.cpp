// `marti study stability` as its user meets it: exit status, table, files, refusals.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

// All cases are tests of their own, without the command.
const std::string small_cases =
    " --set stability.rays=100 --set stability.nodes=64"
    " --set 'stability.only=[\"leaks-at-1e6\",\"zero-latencies\"]'";

TEST(StabilityCommand, PrintsAndWritesItsTables) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const Outcome outcome = marti("study stability" + small_cases + " -o " + quoted(out));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* text :
       {"what_could_go_wrong", "leaks-at-1e6", "zero-latencies", "Floats beside doubles", " 0 failed"}) {
    EXPECT_TRUE(says(outcome, text)) << text;
  }
  EXPECT_FALSE(says(outcome, "FAIL"));
  for (const char* name :
       {"stability.csv", "float_double.csv", "columns.csv", "report.txt", "results.sqlite"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  const std::string csv = read(out / "stability.csv");
  EXPECT_EQ(csv.find("group,case,what_could_go_wrong,oracle,figure,objection,limit,verdict"), 0U) << csv;
}

TEST(StabilityCommand, RefusesWhatHasNoEffectOrIsOutOfRange) {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    const fs::path out = directory.path() / "none";
    expect_refused("study stability -o " + quoted(out) + options, complaint);
    EXPECT_FALSE(fs::exists(out / "stability.csv"));
  };
  refused(" --set machine.nodes=4", "machine.nodes");
  refused(" --set scene.source=teapot", "scene.source");
  refused(" --set 'stability.only=[\"zero-latency\"]'", "did you mean \"zero-latencies\"");
  refused(" --set stability.rays=0", "stability.rays");
  refused(" --set stability.nodes=4000000000", "stability.nodes");
}

}  // namespace
}  // namespace marti::test
