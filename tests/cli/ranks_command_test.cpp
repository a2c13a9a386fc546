// `marti sweep` under mpirun: on any number of processes it gives the store of one process, and
// continues after a killed process.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/shell.h"
#include "tests/support/store_dump.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

// Two frames, batches of several kinds, 96 machines.
constexpr const char* config_text = R"(
[scene]
source = "teapot:3"
[image]
width = 40
height = 40
max_depth = 2
[machine]
nodes = 2
[sweep.axes]
scene.source = ["teapot:3", "tetra:3"]
machine.nodes = [1, 2, 4, 8]
cache.size = ["1 KiB", "4 KiB", "16 KiB"]
interconnect.kind = ["bus", "crossbar"]
cache.line = ["16 B", "32 B"]
)";

// The leaks that the sanitizer finds at the end are those of Open MPI.
std::string mpirun(int ranks, const std::string& arguments) {
  return "ASAN_OPTIONS=detect_leaks=0 mpirun --allow-run-as-root --oversubscribe --bind-to none -n " +
         std::to_string(ranks) + " " + quoted(MARTI_PROGRAM) + " " + arguments;
}

// Two ranks, each in a directory of its own.
Outcome in_two_directories(const fs::path& first, const fs::path& second, const std::string& arguments) {
  const std::string program = " -n 1 " + quoted(MARTI_PROGRAM) + " " + arguments;
  return shell(
      "ASAN_OPTIONS=detect_leaks=0 mpirun --allow-run-as-root --oversubscribe --bind-to none -wdir " +
      quoted(first) + program + " : -wdir " + quoted(second) + program);
}

class RankedSweep : public ::testing::Test {
 protected:
  void SetUp() override {
    if (shell("command -v mpirun").status != 0) {
      GTEST_SKIP() << "mpirun is not there (Debian: openmpi-bin)";
    }
    write(config_, config_text);
  }
  [[nodiscard]] std::string sweep(const fs::path& directory) const {
    return "sweep " + quoted(config_) + " -o " + quoted(directory) + settings_;
  }
  [[nodiscard]] fs::path at(const char* name) const { return directory_.path() / name; }
  [[nodiscard]] std::string store_of_one_process() const {
    const Outcome outcome = marti(sweep(at("one")));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return dump(at("one") / "results.sqlite");
  }

  TemporaryDirectory directory_;
  fs::path config_ = directory_.path() / "sweep.toml";
  std::string settings_;  // of all sweeps of a test, beside those of the file
};

TEST_F(RankedSweep, GivesTheStoreOfOneProcess) {
  const std::string expected = store_of_one_process();
  ASSERT_NE(expected.find("integrity: ok"), std::string::npos);
  for (const int ranks : {1, 2, 4}) {
    const fs::path directory = at(("ranks" + std::to_string(ranks)).c_str());
    const Outcome outcome = shell(mpirun(ranks, sweep(directory) + " --threads 2"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(dump(directory / "results.sqlite"), expected) << ranks << " ranks";
    EXPECT_EQ(read(directory / "points.csv"), read(at("one") / "points.csv"));
    EXPECT_TRUE(says(outcome, "timed         96 machines on 2 frames"));
    EXPECT_EQ(
        outcome.output.find("wrote", outcome.output.find("wrote", outcome.output.find("wrote") + 1) + 1),
        std::string::npos)
        << "said once: " << outcome.output;
  }
}

TEST_F(RankedSweep, OnlyRankZeroNeedsTheFile) {
  const fs::path first = at("first");
  fs::create_directory(first);
  fs::rename(config_, first / "sweep.toml");
  const Outcome outcome = in_two_directories(first, directory_.path(), "sweep sweep.toml -o results");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(first / "results" / "results.sqlite"));
  EXPECT_FALSE(fs::exists(at("results")));
}

TEST_F(RankedSweep, ScenesMustBeTheSameOnAllComputers) {
  const fs::path first = at("first");
  const fs::path second = at("second");
  fs::create_directory(first);
  fs::create_directory(second);
  write(
      first / "sweep.toml",
      "[scene]\nsource = \"s.glb\"\n[image]\nwidth = 9\nheight = 9\n[sweep.axes]\nmachine.nodes = [1, 2]\n");
  ASSERT_EQ(marti("scene export tetra:2 " + quoted(first / "s.glb")).status, 0);
  for (const bool other : {false, true}) {
    if (other) {
      ASSERT_EQ(marti("scene export tetra:1 " + quoted(second / "s.glb")).status, 0);
    }
    const Outcome outcome = in_two_directories(first, second, "sweep sweep.toml -o results");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    const std::string said = other ? "marti: rank 1: makes other frames or machines" : "marti: rank 1: ";
    const std::size_t at = outcome.output.find(said);
    ASSERT_NE(at, std::string::npos) << outcome.output;
    EXPECT_EQ(outcome.output.find("marti: rank", at + 1), std::string::npos) << outcome.output;
  }
  fs::copy_file(first / "s.glb", second / "s.glb", fs::copy_options::overwrite_existing);
  EXPECT_EQ(in_two_directories(first, second, "sweep sweep.toml -o results").status, 0);
}

TEST_F(RankedSweep, LogsThatDoNotFitAreTracedAgain) {
  const Outcome first = shell(mpirun(2, sweep(at("a")) + " --set 'host_machine.memory_limit=\"2 MiB\"'"));
  ASSERT_EQ(first.status, 0) << first.output;
  const Outcome second = shell(mpirun(2, sweep(at("b"))));
  ASSERT_EQ(second.status, 0) << second.output;
  EXPECT_EQ(dump(at("a") / "results.sqlite"), dump(at("b") / "results.sqlite"));
  for (const auto& entry : fs::directory_iterator(at("a"))) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
}

TEST_F(RankedSweep, SaysOnceWhatIsWrong) {
  const Outcome outcome = shell(mpirun(3, sweep(at("a")) + " --set machine.nodes=0"));
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  const std::size_t said = outcome.output.find("marti: --set machine.nodes=0");
  ASSERT_NE(said, std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("marti: --set machine.nodes=0", said + 1), std::string::npos)
      << outcome.output;
}

TEST_F(RankedSweep, AnotherLauncherIsRefused) {
  const Outcome outcome = shell("SLURM_STEP_NUM_TASKS=3 ASAN_OPTIONS=detect_leaks=0 " +
                                quoted(MARTI_PROGRAM) + " " + sweep(at("a")));
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_TRUE(says(outcome, "3 processes were started together, but this program's MPI sees 1"));
  EXPECT_FALSE(fs::exists(at("a")));
}

TEST_F(RankedSweep, OnlyPlans) {
  const Outcome outcome = shell(mpirun(2, "sweep --plan " + quoted(config_)));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "96"));
}

/// Results in a store that another process may be writing; 0 while there is none.
long results_in(const fs::path& store) {
  return fs::exists(store) ? std::max(0L, number_of(store, "SELECT COUNT(*) FROM host_machines")) : 0;
}

/// The process of that rank below `parent`; 0 when there is none.
pid_t process_of_rank(pid_t parent, int rank) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string stat = read(entry.path() / "stat");
    const std::size_t end = stat.rfind(')');
    if (end == std::string::npos || std::atoi(stat.c_str() + end + 4) != parent) {
      continue;
    }
    const std::string variable = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
    const std::string environment = '\0' + read(entry.path() / "environ");
    if (environment.find('\0' + variable + '\0') != std::string::npos) {
      return std::atoi(stat.c_str());
    }
  }
  return 0;
}

class KilledRank : public RankedSweep, public ::testing::WithParamInterface<int> {};

TEST_P(KilledRank, LosesOnlyWhatWasInFlight) {
  settings_ = " --set image.width=160 --set image.height=160";  // so that it is not over before it is killed
  const std::string expected = store_of_one_process();
  const fs::path directory = at("killed");
  const std::string command =
      "exec env " + mpirun(2, sweep(directory) + " --threads 1") + " > " + quoted(at("output")) + " 2>&1";
  const pid_t job = fork();
  if (job == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  bool ended = false;
  while (!ended && results_in(directory / "results.sqlite") < 5) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ended = waitpid(job, &status, WNOHANG) == job;
  }
  if (ended && status == 0) {
    GTEST_SKIP() << "it ended before it could be killed";
  }
  ASSERT_FALSE(ended) << read(at("output"));
  const pid_t process = process_of_rank(job, GetParam());
  ASSERT_NE(process, 0);
  kill(process, SIGKILL);
  ASSERT_EQ(waitpid(job, &status, 0), job);
  EXPECT_TRUE(!WIFEXITED(status) || WEXITSTATUS(status) != 0) << read(at("output"));
  const long saved = results_in(directory / "results.sqlite");
  EXPECT_GE(saved, 5);
  const Outcome rest = shell(mpirun(2, sweep(directory)));
  ASSERT_EQ(rest.status, 0) << rest.output;
  EXPECT_TRUE(says(rest, "timed         " + std::to_string(96 - saved) + " machine"));
  EXPECT_EQ(dump(directory / "results.sqlite"), expected);
  for (const auto& entry : fs::directory_iterator(directory)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
}

INSTANTIATE_TEST_SUITE_P(RankedSweep, KilledRank, ::testing::Values(0, 1));

}  // namespace
}  // namespace marti::test
