// A sweep that ends early: killed, interrupted, on a full disk, beside another one.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "sim/descriptor.h"
#include "tests/cli/started.h"
#include "tests/cli/sweep_files.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::vector<std::string> arguments(const fs::path& config, const fs::path& out,
                                   const std::vector<std::string>& more = {}) {
  std::vector<std::string> all = {"sweep", config.string(), "-o", out.string(), "--quiet"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

long results_in(const fs::path& out) {
  const fs::path store = out / "results.sqlite";
  // A program that has only begun may not have made its tables.
  return fs::exists(store) ? std::max(0L, number_of(store, "SELECT COUNT(*) FROM results")) : 0;
}

// Waits until some machines are done; false when the program ended before.
bool wait_for_results(Started& program, const fs::path& out, long how_many) {
  while (results_in(out) < how_many) {
    if (program.ended()) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

class SweepKilled : public testing::TestWithParam<unsigned> {};

// However often and whenever it was killed, the same command times only the missing machines.
TEST_P(SweepKilled, ComesToTheSameEnd) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  write(config, long_sweep);
  const fs::path whole = directory.path() / "whole";
  const Clock::time_point begin = Clock::now();
  ASSERT_EQ(sweep(config, whole).status, 0);
  const std::chrono::duration<double> takes = Clock::now() - begin;
  const std::string expected = dump(whole / "results.sqlite");

  std::mt19937_64 random(GetParam());
  std::uniform_real_distribution<double> part(0.02, 0.6);
  const fs::path out = directory.path() / "out";
  int killed = 0;
  bool ended = false;
  for (int round = 0; round < 6 && !ended; ++round) {
    Started program(arguments(config, out, {"--threads", std::to_string(1 + random() % 4)}),
                    directory.path() / "said");
    // The first kill comes surely before the sweep ends.
    std::this_thread::sleep_for(takes * part(random) * (round == 0 ? 0.4 : 1.0));
    program.send(SIGKILL);
    const int status = program.wait();
    ASSERT_TRUE(status == 0 || status == -SIGKILL) << read(directory.path() / "said");
    killed += status == 0 ? 0 : 1;
    ended = status == 0;
  }
  EXPECT_GT(killed, 0);
  const long before = results_in(out);
  const Outcome last = sweep(config, out);
  ASSERT_EQ(last.status, 0) << last.output;
  EXPECT_TRUE(says(last, std::to_string(before) + " done\n")) << before;
  EXPECT_EQ(dump(out / "results.sqlite"), expected);
  EXPECT_EQ(read(out / "points.csv"), read(whole / "points.csv"));
  EXPECT_EQ(names_in(out).size(), 2U) << "nothing that the killed ones left";
}
INSTANTIATE_TEST_SUITE_P(Seeds, SweepKilled, testing::Range(1U, 5U));

class SweepInterrupted : public testing::TestWithParam<std::tuple<int, const char*>> {};

TEST_P(SweepInterrupted, SaysWhatIsSavedAndCanGoOn) {
  const auto& [signal, memory] = GetParam();
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  write(config, long_sweep);
  const fs::path out = directory.path() / "out";
  {
    Started program(
        arguments(config, out,
                  {"--threads", "2", "--set", std::string("host_machine.memory_limit=") + memory}),
        directory.path() / "said");
    ASSERT_TRUE(wait_for_results(program, out, 3)) << read(directory.path() / "said");
    program.send(signal);
    EXPECT_EQ(program.wait(), 128 + signal) << read(directory.path() / "said");
  }
  const long saved = results_in(out);
  EXPECT_GE(saved, 3);
  EXPECT_LT(saved, 320);
  const std::string said = read(directory.path() / "said");
  EXPECT_NE(said.find("marti: interrupted: " + std::to_string(saved) + " of 320 machines are saved in " +
                      (out / "results.sqlite").string()),
            std::string::npos)
      << saved << "\n"
      << said;
  EXPECT_EQ(names_in(out).size(), 1U) << "the store alone, without its log or temporary files";
  const Outcome last = sweep(config, out);
  ASSERT_EQ(last.status, 0) << last.output;
  EXPECT_TRUE(says(last, std::to_string(saved) + " done\n"));
  const fs::path whole = directory.path() / "whole";
  ASSERT_EQ(sweep(config, whole).status, 0);
  EXPECT_EQ(dump(out / "results.sqlite"), dump(whole / "results.sqlite"));
}
INSTANTIATE_TEST_SUITE_P(Signals, SweepInterrupted,
                         testing::Values(std::tuple(SIGINT, "1GiB"), std::tuple(SIGTERM, "1GiB"),
                                         std::tuple(SIGINT, "1MiB")));

// Whenever a signal comes, SQLite's files beside the store are gone with the program: while the store is
// begun, and of a sweep that is over soon while it is closed.
TEST(SweepEnd, ASignalLeavesNothingOfSqliteBesideTheStore) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  int interrupted = 0;
  for (int round = 0; round < 24; ++round) {
    write(config, round % 2 == 0
                      ? long_sweep
                      : "[scene]\nsource = \"tetra:1\"\n[image]\nwidth = 8\nheight = 8\n[sweep.axes]\n"
                        "machine.nodes = [1, 2]\n");
    const fs::path out = directory.path() / std::to_string(round);
    Started program(arguments(config, out, {"--threads", "1"}), directory.path() / "said");
    while (!fs::exists(out / "results.sqlite") && !program.ended()) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(round));
    program.send(SIGINT);
    interrupted += program.wait() == 0 ? 0 : 1;
    for (const std::string& name : names_in(out)) {
      EXPECT_EQ(name.find("sqlite-"), std::string::npos) << name << " after " << round << " ms";
    }
  }
  EXPECT_GT(interrupted, 0);
}

// A signal while a sweep or a suite takes its lock leaves no lock, and is answered.
TEST(SweepEnd, ASignalAtOnceLeavesNoLock) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  write(config, small_sweep);
  for (int round = 0; round < 48; ++round) {
    const fs::path out = directory.path() / std::to_string(round);
    Started program(arguments(config, out, {"--threads", "1"}), directory.path() / "said");
    while (!fs::exists(out / "results.sqlite.lock") && !program.ended()) {
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
    program.send(SIGTERM);
    if (program.wait() != 0) {
      EXPECT_EQ(names_in(out), std::set<std::string>{"results.sqlite"});
      EXPECT_NE(read(directory.path() / "said").find("marti: interrupted: "), std::string::npos);
    }
  }
}

TEST(SweepEnd, TwoAtOnceOnOneStoreAreRefused) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  // Long enough that the second begins before it ends.
  std::string longer = long_sweep;
  for (std::size_t at = 0; (at = longer.find("= 32", at)) != std::string::npos;) {
    longer.replace(at, 4, "= 96");
  }
  write(config, longer);
  const fs::path out = directory.path() / "out";
  Started first(arguments(config, out, {"--threads", "1"}), directory.path() / "said");
  ASSERT_TRUE(wait_for_results(first, out, 1)) << read(directory.path() / "said");
  const Outcome second = sweep(config, out);
  if (first.ended()) {
    GTEST_SKIP() << "the first was too quick for this test";
  }
  EXPECT_EQ(second.status, 2);
  EXPECT_TRUE(says(second, (out / "results.sqlite").string()));
  EXPECT_TRUE(says(second, "process"));
  EXPECT_EQ(first.wait(), 0) << read(directory.path() / "said");
  EXPECT_EQ(results_in(out), 320);
}

// A store that somebody writes may look damaged to others: who writes it comes first.
TEST(SweepEnd, TheLockIsTakenBeforeTheStoreIsRead) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  write(config, small_sweep);
  const fs::path out = directory.path() / "out";
  fs::create_directory(out);
  write(out / "results.sqlite", "half of a store");
  const fs::path lock = out / "results.sqlite.lock";
  write(lock, "process 1 on another computer\n");
  {
    const sim::Descriptor held(open(lock.c_str(), O_RDWR | O_CLOEXEC));
    ASSERT_EQ(flock(held.get(), LOCK_EX), 0);
    const Outcome refused = sweep(config, out);
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(says(refused, "process 1 on another computer is writing it"));
  }
  const Outcome damaged = sweep(config, out);
  EXPECT_EQ(damaged.status, 2);
  EXPECT_TRUE(says(damaged, "results.sqlite: is no SQLite database"));
  EXPECT_EQ(read(out / "results.sqlite"), "half of a store");
}

TEST(SweepEnd, AFullDiskIsToldAndTheSweepGoesOnLater) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  write(config, long_sweep);
  const fs::path out = directory.path() / "out";
  // In units of 512 bytes or 1 KiB, as the shell has it: not even room for the tables, for the plan, or for a
  // result, and room for some machines. Without a result nothing is left.
  for (const char* most : {"1", "8", "20", "100", "400", "1200"}) {
    const Outcome full = shell(std::string("ulimit -f ") + most + "; trap '' XFSZ; " + quoted(MARTI_PROGRAM) +
                               " sweep " + quoted(config) + " --quiet -o " + quoted(out));
    EXPECT_EQ(full.status, 2) << full.output;
    EXPECT_TRUE(says(full, "marti: " + (out / "results.sqlite").string()));
    EXPECT_EQ(fs::exists(out), most == std::string("1200")) << full.output;
  }
  const Outcome last = sweep(config, out);
  ASSERT_EQ(last.status, 0) << last.output;
  const fs::path whole = directory.path() / "whole";
  ASSERT_EQ(sweep(config, whole).status, 0);
  EXPECT_EQ(dump(out / "results.sqlite"), dump(whole / "results.sqlite"));
}

}  // namespace
}  // namespace marti::test
