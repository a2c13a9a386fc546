// `marti study` as its user meets it: exit status, messages, files.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const fs::path shipped_paper = fs::path(MARTI_SOURCE) / "configs" / "paper.toml";

// The shipped study with scenes that take no time.
const std::string small_paper =
    quoted(shipped_paper) +
    " --set image.width=24 --set image.height=16"
    " --set 'paper.scenes=[\"tetra:2\"]'"
    " --set 'paper.run_scenes=[\"teapot:2:pot\",\"teapot:2:pot\"]'"
    " --set 'paper.run_depths=[2,4]' --set 'paper.levels=[1,3]' --set paper.host_repetitions=1";

TEST(Study, ThePaperWritesTablesChartsAndADatabase) {
  const TemporaryDirectory directory;
  const fs::path a = directory.path() / "a";
  const fs::path b = directory.path() / "b";
  const Outcome outcome = marti("study paper " + small_paper + " -o " + quoted(a));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* text : {"Table 1", "Figure 3", "The paper's statements", "results.sqlite"}) {
    EXPECT_NE(outcome.output.find(text), std::string::npos) << text;
  }
  ASSERT_EQ(marti("study paper " + small_paper + " -o " + quoted(b)).status, 0);
  EXPECT_GE(expect_same_files(a, b), 12);
}

TEST(Study, ReplacesNoSweep) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "a.toml";
  write(config, "[scene]\nsource = \"teapot:2\"\n[image]\nwidth = 8\nheight = 8\n");
  const std::string out = " -o " + quoted(directory.path() / "out");
  const std::string sweep = "sweep " + quoted(config) + " --axis machine.nodes=1,2 --quiet" + out;
  ASSERT_EQ(marti(sweep).status, 0);
  expect_refused("study operations " + quoted(config) + out, "results.sqlite: is the store of a sweep");
  EXPECT_TRUE(says(marti(sweep), "2 done")) << "the sweep's points stay";
}

TEST(Study, WrongInputIsTwoAndOlderResultsStay) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("study paper " + small_paper + " -o " + quoted(out)).status, 0);
  const std::string before = read(out / "table1.csv") + read(out / "results.sqlite");
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("study paper " + small_paper + options, complaint);
  };
  refused(" -o " + quoted(out) + " --set 'paper.scenes=[\"teapott:2\"]'", "teapott");
  refused(" -o " + quoted(out) + " --set 'paper.run_depths=[2]'", "paper.run_depths");
  refused(" -o " + quoted(out) + " --set scene.source=tetra:1", "scene.source");
  refused(" -o " + quoted(out) + " --set structure.kind=grid", "structure");
  refused(" -o " + quoted(out) + " --set paper.scene=1", "paper.scenes");
  refused("", "--output");
  refused(" -o ''", "empty");
  write(directory.path() / "file", "in the way");
  refused(" -o " + quoted(directory.path() / "file"), "file");
  refused(" -o " + quoted(directory.path() / "file" / "below"), "file");
  EXPECT_EQ(read(out / "table1.csv") + read(out / "results.sqlite"), before);
  EXPECT_EQ(marti("study").status, 2);
  EXPECT_EQ(marti("study papyrus").status, 2);
  EXPECT_EQ(marti("study paper").status, 2);
  EXPECT_EQ(marti("study paper --help").status, 0);
  EXPECT_EQ(marti("study paper /nonexistent.toml -o " + quoted(out)).status, 2);
}

TEST(Study, WhatIsRefusedLeavesNoDirectory) {
  const TemporaryDirectory directory;
  const fs::path configs = fs::path(MARTI_SOURCE) / "configs";
  const std::string out = " --set scene.source=none.glb -o " + quoted(directory.path() / "new" / "below");
  for (const std::string& study :
       {"operations " + quoted(configs / "marti.toml"), "paper " + quoted(configs / "paper.toml"),
        "frames " + quoted(configs / "marti.toml"), "schemes " + quoted(configs / "schemes.toml"),
        "error " + quoted(configs / "error.toml"), std::string("stability")}) {
    expect_refused("study " + study + out, "scene.source");
    EXPECT_FALSE(fs::exists(directory.path() / "new")) << study;
  }
}

TEST(Study, AFullDiskLeavesTheOldResults) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("study paper " + small_paper + " -o " + quoted(out)).status, 0);
  const std::string before = read(out / "table1.csv") + read(out / "results.sqlite");
  const auto files = std::distance(fs::directory_iterator(out), {});
  // Files larger than a few blocks cannot be written, as on a full disk: the database cannot.
  const Outcome full = shell("ulimit -f 8; trap '' XFSZ; " + quoted(MARTI_PROGRAM) + " study paper " +
                             small_paper + " --set node.clock=40MHz -o " + quoted(out));
  EXPECT_EQ(full.status, 2) << full.output;
  EXPECT_EQ(read(out / "table1.csv") + read(out / "results.sqlite"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(out), {}), files) << "nothing may be left behind";
}

TEST(Study, ShippedConfigurationNamesWhatExists) {
  // Read by another command, the study's own section is not known.
  expect_refused("run " + quoted(shipped_paper), "paper");
}

}  // namespace
}  // namespace marti::test
