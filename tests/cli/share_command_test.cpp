// `marti sweep` on several processes: merged, their shares are the store of one process, whoever was killed.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "studies/tables/sqlite_connection.h"
#include "tests/cli/started.h"
#include "tests/cli/sweep_files.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

class SharedSweep : public testing::Test {
 protected:
  void SetUp() override { write(config_, small_sweep); }
  [[nodiscard]] fs::path at(const std::string& name) const { return directory_.path() / name; }
  [[nodiscard]] std::string command(const fs::path& out, const std::string& more) const {
    return quoted(MARTI_PROGRAM) + " sweep " + quoted(config_) + " -o " + quoted(out) +
           " --quiet --threads 1 " + more;
  }
  // The sweep of one process, and that the other directory holds the same.
  void expect_that_of_one_process(const fs::path& out) {
    ASSERT_EQ(sweep(config_, at("one")).status, 0);
    EXPECT_TRUE(dump(out / "results.sqlite") == dump(at("one") / "results.sqlite"));
    EXPECT_TRUE(read(out / "points.csv") == read(at("one") / "points.csv"));
    const std::set<std::string> files = {"points.csv", "results.sqlite"};
    EXPECT_EQ(names_in(out), files);
  }

  TemporaryDirectory directory_;
  fs::path config_ = at("sweep.toml");
};

TEST_F(SharedSweep, TheProcessThatEndsLastMerges) {
  for (const int processes : {2, 3}) {
    const fs::path out = at("out" + std::to_string(processes));
    std::string together;
    for (int process = 0; process < processes; ++process) {
      // As mpirun starts them.
      together += "OMPI_COMM_WORLD_RANK=" + std::to_string(process) +
                  " OMPI_COMM_WORLD_SIZE=" + std::to_string(processes) + " " + command(out, "") + " & p" +
                  std::to_string(process) + "=$!; ";
    }
    for (int process = 0; process < processes; ++process) {
      together += "wait $p" + std::to_string(process) + " || exit; ";
    }
    const Outcome outcome = shell(together);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const std::string merged = "wrote         " + (out / "results.sqlite").string();
    const std::size_t said = outcome.output.find(merged);
    ASSERT_NE(said, std::string::npos) << outcome.output;
    EXPECT_EQ(outcome.output.find(merged, said + 1), std::string::npos) << "merged twice: " << outcome.output;
    expect_that_of_one_process(out);
  }
}

TEST_F(SharedSweep, SharesMayBeTimedOneAfterAnother) {
  const fs::path out = at("out");
  const Outcome first = shell(command(out, "--share 1/3"));
  ASSERT_EQ(first.status, 0) << first.output;
  EXPECT_TRUE(says(first, "share         1 of 3: "));
  EXPECT_TRUE(says(first, "the last one merges them"));
  EXPECT_TRUE(fs::exists(out / "results.1-of-3.sqlite"));
  EXPECT_FALSE(fs::exists(out / "results.sqlite"));
  const long timed = number_of(out / "results.1-of-3.sqlite", "SELECT COUNT(*) FROM results");
  EXPECT_TRUE(says(marti("sweep --plan " + quoted(config_) + " -o " + quoted(out)),
                   ", " + std::to_string(timed) + " done"));
  EXPECT_TRUE(says(shell(command(out, "--share 1/3")), "all of it was there already"));
  ASSERT_EQ(shell(command(out, "--share 3/3")).status, 0);
  const Outcome last = shell(command(out, "--share 2/3 --best end"));
  EXPECT_TRUE(says(last, "wrote         " + (out / "points.csv").string()));
  EXPECT_TRUE(says(last, "best"));
  expect_that_of_one_process(out);
  EXPECT_TRUE(says(shell(command(out, "--share 2/3")), "all of it was there already"));
}

TEST_F(SharedSweep, WhatIsMissingIsTimedByTheCommandWithoutAShare) {
  const fs::path out = at("out");
  ASSERT_EQ(shell(command(out, "--share 2/5")).status, 0);
  ASSERT_EQ(shell(command(out, "--share 1/2")).status, 0);  // some machines are in both
  const Outcome rest = shell(command(out, ""));
  ASSERT_EQ(rest.status, 0) << rest.output;
  EXPECT_FALSE(says(rest, "timed         24 machines"));
  expect_that_of_one_process(out);
  EXPECT_EQ(number_of(out / "results.sqlite", "SELECT COUNT(*) FROM host_machines"), 24);
  EXPECT_EQ(number_of(out / "results.sqlite", "SELECT COUNT(DISTINCT session) FROM host_machines"), 3);
}

// A store that other plans have used has other ids than the parts.
TEST_F(SharedSweep, PartsAreMergedIntoAStoreThatWasThere) {
  const fs::path out = at("out");
  for (const fs::path& directory : {out, at("one")}) {
    ASSERT_EQ(sweep(config_, directory, "--axis machine.nodes=4,7 --axis cache.size=4KiB").status, 0);
  }
  ASSERT_EQ(shell(command(out, "--share 1/2")).status, 0);
  EXPECT_TRUE(says(shell(command(out, "--share 2/2")), "wrote         " + (out / "points.csv").string()));
  expect_that_of_one_process(out);
}

TEST_F(SharedSweep, APartOfAnotherPlanIsKept) {
  const fs::path out = at("out");
  ASSERT_EQ(shell(command(out, "--share 1/2 --axis machine.nodes=5,6")).status, 0);
  ASSERT_EQ(shell(command(out, "")).status, 0);
  EXPECT_TRUE(fs::exists(out / "results.1-of-2.sqlite"));
  const Outcome other = shell(command(out, "--axis machine.nodes=5,6"));
  EXPECT_FALSE(says(other, "timed         16 machines"));
  EXPECT_FALSE(fs::exists(out / "results.1-of-2.sqlite"));
}

TEST_F(SharedSweep, AKilledShareLosesNothingOfTheOthers) {
  write(config_, long_sweep);
  const fs::path out = at("out");
  const auto arguments = [&](const std::string& share) {
    return std::vector<std::string>{"sweep", config_.string(), "-o", out.string(), "--quiet", "--share",
                                    share,   "--threads",      "1"};
  };
  const fs::path part = out / "results.2-of-2.sqlite";
  const auto results = [&] {
    return fs::exists(part) ? number_of(part, "SELECT COUNT(*) FROM results") : -1;
  };
  bool killed = false;
  {
    Started first(arguments("1/2"), at("first"));
    Started second(arguments("2/2"), at("second"));
    while (results() < 5 && !second.ended()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    const Outcome beside = shell(command(out, ""));
    if (!second.ended()) {
      second.send(SIGKILL);
      killed = true;
      EXPECT_EQ(beside.status, 2) << "a part that is being written is not merged: " << beside.output;
    }
    EXPECT_EQ(first.wait(), 0) << read(at("first"));
    second.wait();
  }
  if (!killed) {
    GTEST_SKIP() << "it ended before it could be killed";
  }
  EXPECT_FALSE(fs::exists(out / "points.csv")) << read(at("first"));
  const long saved = results();
  EXPECT_GE(saved, 5);
  EXPECT_EQ(shell(command(out, "")).status, 0);
  expect_that_of_one_process(out);
}

TEST_F(SharedSweep, APartThatMayNotBeMergedIsRefused) {
  const fs::path out = at("out");
  const fs::path part = out / "results.1-of-2.sqlite";
  for (const auto& [change, message] :
       {std::pair("UPDATE results SET end = end + 1 WHERE machine = 1", "does not match its checksum"),
        std::pair("UPDATE store SET value = 'other' WHERE what = 'build'", "another build"),
        std::pair("PRAGMA user_version = 99", "format 99")}) {
    fs::remove_all(out);
    ASSERT_EQ(shell(command(out, "--share 1/2")).status, 0);
    studies::tables::SqliteConnection(part, studies::tables::SqliteConnection::Access::write).execute(change);
    for (const char* const share : {"--share 1/2", ""}) {
      const Outcome outcome = shell(command(out, share));
      EXPECT_EQ(outcome.status, 2) << change << outcome.output;
      EXPECT_TRUE(says(outcome, part.string()));
      EXPECT_TRUE(says(outcome, message));
    }
    EXPECT_TRUE(fs::exists(part));
  }
}

TEST_F(SharedSweep, WrongSharesAreRefused) {
  EXPECT_TRUE(says(shell(command(at("out"), "--share 9/8")), "the third of eight is 3/8"));
  expect_refused("sweep --plan --share 1/2 " + quoted(config_), "leave out --json, --best and --share");
  EXPECT_FALSE(fs::exists(at("out")));
}

}  // namespace
}  // namespace marti::test
