// The program under limits on memory and threads: it succeeds, or ends with one message and status 2.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

class Limits : public ::testing::Test {
 protected:
  Limits() { write(file(), "[image]\nwidth = 24\nheight = 16\n[scene]\nsource = \"teapot:12\"\n"); }
  [[nodiscard]] std::filesystem::path file() const { return directory_.path() / "a.toml"; }
  // `before` limits the program that follows it.
  [[nodiscard]] Outcome run(const std::string& before, const std::string& settings = "") const {
    return shell(before + quoted(MARTI_PROGRAM) + " run " + quoted(file()) + settings);
  }
  TemporaryDirectory directory_;
};

TEST_F(Limits, TreesAreRefusedWhileTheyGrow) {
  for (const std::string kind : {"octree", "bsp"}) {
    const Outcome outcome = run("", " --set structure.kind=" + kind +
                                        " --set structure.max_level=21 --set structure.max_objects=1" +
                                        " --set host_machine.memory_limit=32MiB");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_TRUE(says(outcome, "--set host_machine.memory_limit=32MiB"));
    EXPECT_TRUE(says(outcome, "structure.max_level"));
    EXPECT_TRUE(says(outcome, "more than 32 MiB"));
  }
}

TEST_F(Limits, SceneAndLogAreRefused) {
  const Outcome scene = run("", " --set host_machine.memory_limit=1MiB");
  EXPECT_EQ(scene.status, 2);
  EXPECT_TRUE(says(scene, "the scene"));
  const Outcome log =
      run("", " --set image.width=4096 --set image.height=4096 --set host_machine.memory_limit=99MiB");
  EXPECT_EQ(log.status, 2);
  EXPECT_TRUE(says(log, "work log"));
  const Outcome little = run("", " --set host_machine.memory_limit=1KiB");
  EXPECT_EQ(little.status, 2);
  EXPECT_TRUE(says(little, "less than 1 MiB"));
}

TEST_F(Limits, APlanIsRefusedBeforeItsPointsAreRead) {
  write(file(),
        "[host_machine]\nmemory_limit = \"64 MiB\"\n[sweep.axes]\nmachine.nodes = \"1..1000\"\n"
        "host.latency_cycles = \"1..1000\"\n");
  const Outcome outcome = marti("sweep " + quoted(file()) + " --plan");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_TRUE(says(outcome, "the plan of 1000000 points takes about"));
  EXPECT_TRUE(says(outcome, "host_machine.memory_limit: the plan of"));
}

// The results with the default limit are those with any other limit.
TEST_F(Limits, TheDefaultDoesNotEnterResults) {
  if (MARTI_SANITIZED) {
    GTEST_SKIP() << "a sanitizer takes terabytes of address space";
  }
  const Outcome free = run("", " --json");
  const Outcome tight = run("ulimit -v 4000000; ", " --json");
  ASSERT_EQ(free.status, 0) << free.output;
  EXPECT_EQ(free.output, tight.output);
}

// Too little address space for a thread, for oneTBB's, for the scene, for all: never an abort, one line that
// says so, and what was in the directory before is still there.
TEST_F(Limits, LittleAddressSpaceIsNoAbort) {
  if (MARTI_SANITIZED) {
    GTEST_SKIP() << "a sanitizer takes terabytes of address space";
  }
  ASSERT_EQ(run("", " --set machine.nodes=3 -o " + quoted(directory_.path() / "out")).status, 0);
  std::map<std::string, std::string> before = files_of(directory_.path() / "out");
  int done = 0;
  for (const int kibibytes :
       {60'000, 100'000, 150'000, 200'000, 250'000, 300'000, 400'000, 600'000, 2'000'000}) {
    for (const std::string& out : {std::string(), " -o " + quoted(directory_.path() / "out")}) {
      const Outcome outcome = run("ulimit -v " + std::to_string(kibibytes) + "; ", out);
      // Below some size not even the dynamic linker has room.
      const bool not_begun = outcome.status == 127 && says(outcome, "shared libraries");
      EXPECT_TRUE(outcome.status == 0 || (outcome.status == 2 && says(outcome, "marti: ")) || not_begun)
          << kibibytes << ": " << outcome.status << ": " << outcome.output;
      done += outcome.status == 0 ? 1 : 0;
      const std::map<std::string, std::string> after = files_of(directory_.path() / "out");
      if (outcome.status != 0) {
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        EXPECT_TRUE(before == after) << kibibytes;
      }
      before = after;
    }
  }
  EXPECT_GE(done, 2);
}

// Where host_machine.memory_limit promises more than there is, memory runs out while a frame is timed.
TEST_F(Limits, MemoryThatRunsOutIsOneMessage) {
  if (MARTI_SANITIZED) {
    GTEST_SKIP() << "a sanitizer takes terabytes of address space";
  }
  const std::filesystem::path out = directory_.path() / "sweep";
  const auto sweep = [&](const std::string& before, const std::string& nodes) {
    write(file(),
          "[image]\nwidth = 24\nheight = 16\n[scene]\nsource = \"teapot:2\"\n[cache]\nsize = \"1 MiB\"\n"
          "[host_machine]\nmemory_limit = \"1 TiB\"\n[sweep.axes]\nmachine.nodes = [" +
              nodes + "]\n");
    return shell(before + quoted(MARTI_PROGRAM) + " sweep " + quoted(file()) + " -o " + quoted(out));
  };
  ASSERT_EQ(sweep("", "1, 2").status, 0);
  const std::string points = read(out / "points.csv");
  int refused = 0;
  for (const int kibibytes : {55'000, 65'000, 75'000, 85'000}) {
    const std::string limit = "ulimit -v " + std::to_string(kibibytes) + "; ";
    const Outcome run_out = run(limit,
                                " --set machine.nodes=4096 --set cache.size=1MiB"
                                " --set host_machine.memory_limit=1TiB");
    for (const Outcome& outcome : {run_out, sweep(limit, "1, 2, 4096")}) {
      EXPECT_TRUE(outcome.status == 0 || outcome.status == 2) << outcome.status << ": " << outcome.output;
      if (outcome.status != 0) {
        ++refused;
        // One message, behind the sweep's plan if there was memory for that.
        EXPECT_EQ(outcome.output.find("marti: "), outcome.output.rfind("marti: ")) << outcome.output;
        const std::size_t last = outcome.output.rfind('\n', outcome.output.size() - 2);
        EXPECT_EQ(outcome.output.compare(last == std::string::npos ? 0 : last + 1, 7, "marti: "), 0)
            << outcome.output;
      }
    }
    if (read(out / "points.csv") != points) {
      break;  // the sweep is complete
    }
  }
  EXPECT_GE(refused, 2);
  EXPECT_EQ(sweep("", "1, 2, 4096").status, 0);  // goes on with what is there
}

// As a user who may have few processes: none at all for threads, one, two, ...
TEST_F(Limits, FewProcessesAreNoAbort) {
  if (getuid() != 0) {
    GTEST_SKIP() << "the limit of processes counts all of a user's: only root can be a user without any";
  }
  // The leak sanitizer would need a thread of its own.
  constexpr const char* other =
      "env ASAN_OPTIONS=detect_leaks=0 setpriv --reuid=54321 --regid=54321 --clear-groups ";
  if (shell(std::string(other) + quoted(MARTI_PROGRAM) + " --version").status != 0) {
    GTEST_SKIP() << "another user cannot run " << MARTI_PROGRAM;
  }
  std::filesystem::permissions(directory_.path(), std::filesystem::perms::all);
  int done = 0;
  for (const int processes : {1, 2, 3, 4, 6, 64}) {
    const std::string before = other + ("prlimit --nproc=" + std::to_string(processes) + " ");
    for (const std::string& out : {std::string(), " -o " + quoted(directory_.path() / "out")}) {
      const Outcome outcome = run(before, out);
      EXPECT_TRUE(outcome.status == 0 || (outcome.status == 2 && says(outcome, "no more threads")))
          << processes << ": " << outcome.status << ": " << outcome.output;
      done += outcome.status == 0 ? 1 : 0;
    }
  }
  EXPECT_GE(done, 2);
  const Outcome none = run(other + std::string("prlimit --nproc=1 "));
  EXPECT_EQ(none.status, 2) << none.output;
}

}  // namespace
}  // namespace marti::test
