// Progress on a terminal: commands that take long say what they do and leave nothing of it behind; elsewhere
// nothing is said.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/shell.h"
#include "tests/cli/started.h"
#include "tests/cli/terminal.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

const std::string configs = std::string(MARTI_SOURCE) + "/configs/";

// Takes many seconds on any computer, the most part in replays.
const std::vector<std::string> long_run = {"run",   configs + "marti.toml", "--set",       "image.width=1024",
                                           "--set", "image.height=1024",    "--what-helps"};

TEST(ProgressOnATerminal, ARunSaysWhatItDoesAndOnlyThere) {
  const TemporaryDirectory directory;
  // Beside each other, because each waits two seconds before it says anything.
  Started elsewhere(long_run, directory.path() / "elsewhere");
  OnTerminal explored(
      {"explore", configs + "marti.toml", "--set", "image.width=1024", "--set", "image.height=1024", "--set",
       "cache.size=1 KiB", "--set", "machine.nodes=256", "--no-browser", "--for", "60"},
      directory.path() / "explored");
  OnTerminal study({"study", "paper", configs + "paper.toml", "-o", directory.path() / "results"},
                   directory.path() / "study");
  OnTerminal run(long_run, directory.path() / "run");
  ASSERT_TRUE(run.wait_for("] ")) << "on a busy computer, what is done before it is told, too";
  EXPECT_TRUE(run.screen().starts_with("[")) << run.screen();
  EXPECT_EQ(run.end_by(SIGINT), -SIGINT);
  EXPECT_EQ(run.screen(), "") << "the line is taken away";
  EXPECT_EQ(read(directory.path() / "run"), "");
  ASSERT_TRUE(explored.wait_for(" s"));
  EXPECT_EQ(explored.end_by(SIGINT), -SIGINT);
  EXPECT_EQ(explored.screen(), "");
  ASSERT_TRUE(study.wait_for(" s"));
  EXPECT_EQ(study.end_by(SIGINT), -SIGINT);
  EXPECT_EQ(study.screen(), "");
  elsewhere.send(SIGINT);
  EXPECT_EQ(elsewhere.wait(), -SIGINT);
  EXPECT_EQ(read(directory.path() / "elsewhere"), "");
}

TEST(ProgressOnATerminal, ASweepShowsABarThatGoes) {
  const TemporaryDirectory directory;
  OnTerminal sweep({"sweep", configs + "sweep.toml", "-o", directory.path() / "out"},
                   directory.path() / "printed");
  ASSERT_TRUE(sweep.wait_for("of 1000 machines"));
  EXPECT_EQ(sweep.end_by(SIGINT), 130);
  EXPECT_TRUE(sweep.screen().starts_with("marti: interrupted: ")) << sweep.screen();
  EXPECT_EQ(sweep.screen().find("machines,"), std::string::npos) << sweep.screen();
}

TEST(ProgressOnATerminal, WhatIsDoneSoonSaysNothing) {
  const TemporaryDirectory directory;
  OnTerminal run({"run", configs + "marti.toml", "--set", "scene.source=tetra:1", "--set", "image.width=8",
                  "--set", "image.height=8"},
                 directory.path() / "printed");
  EXPECT_EQ(run.end_by(0), 0);
  EXPECT_EQ(run.screen(), "");
  EXPECT_NE(read(directory.path() / "printed").find("frame"), std::string::npos);
}

}  // namespace
}  // namespace marti::test
