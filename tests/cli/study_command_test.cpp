// `marti study` as its user meets it: exit status, messages, files.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string shipped_paper = shipped("paper.toml");

// The shipped study with scenes that take no time.
const std::string small_paper = shipped_paper +
                                " --set image.width=24 --set image.height=16"
                                " --set 'paper.scenes=[\"tetra:2\"]'"
                                " --set 'paper.run_scenes=[\"teapot:2:pot\",\"teapot:2:pot\"]'"
                                " --set 'paper.run_depths=[2,4]'";

TEST(Study, ThePaperWritesTablesChartsAndADatabase) {
  const TemporaryDirectory directory;
  EXPECT_GE(
      expect_study("paper " + small_paper, directory.path(),
                   {"Table 1", "Figure 3", "Statements beside what was measured", "results.sqlite"}, {}),
      12);
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
  // Of a run and a sweep in one directory nobody could tell later which one is meant.
  expect_refused("run " + quoted(config) + out, "results.sqlite: is there already");
  const std::string run = " -o " + quoted(directory.path() / "run");
  ASSERT_EQ(marti("run " + quoted(config) + run).status, 0);
  expect_refused("study operations " + quoted(config) + run, "result.json: is there already");
  expect_refused("sweep " + quoted(config) + " --axis machine.nodes=1,2" + run,
                 "result.json: is there already");
}

TEST(Study, WrongInputIsTwoAndOlderResultsStay) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("study paper " + small_paper + " -o " + quoted(out)).status, 0);
  const auto before = files_of(out);
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("study paper " + small_paper + options, complaint);
  };
  refused(" -o " + quoted(out) + " --set 'paper.scenes=[\"teapott:2\"]'", "teapott");
  refused(" -o " + quoted(out) + " --set paper.scene=1", "paper.scenes");
  refused("", "--output");
  refused(" -o ''", "empty");
  write(directory.path() / "file", "in the way");
  refused(" -o " + quoted(directory.path() / "file"), "file");
  refused(" -o " + quoted(directory.path() / "file" / "below"), "file");
  EXPECT_EQ(marti("study paper").status, 2);
  EXPECT_EQ(marti("study paper --help").status, 0);
  EXPECT_EQ(marti("study paper /nonexistent.toml -o " + quoted(out)).status, 2);
  EXPECT_TRUE(before == files_of(out));
  expect_kept_on_a_full_disk("paper " + small_paper, out);
}

TEST(Study, WhatIsRefusedLeavesNoDirectory) {
  const TemporaryDirectory directory;
  const fs::path configs = fs::path(MARTI_SOURCE) / "configs";
  const std::string out = " --set scene.source=none.glb -o " + quoted(directory.path() / "new" / "below");
  for (const std::string& study :
       {"operations " + quoted(configs / "marti.toml"), "paper " + quoted(configs / "paper.toml"),
        "frames " + quoted(configs / "marti.toml"), "error " + quoted(configs / "error.toml"),
        "stability " + quoted(configs / "marti.toml")}) {
    expect_refused("study " + study + out, "scene.source");
    EXPECT_FALSE(fs::exists(directory.path() / "new")) << study;
  }
}

TEST(Study, ShippedConfigurationNamesWhatExists) {
  // Read by another command, the study's own section is not known.
  expect_refused("run " + shipped_paper, "paper");
}

}  // namespace
}  // namespace marti::test
