// The program under limits on memory and threads: it succeeds, or ends with one message and status 2.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
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
    EXPECT_TRUE(says(outcome, "--set host_machine.memory_limit=32MiB")) << outcome.output;
    EXPECT_TRUE(says(outcome, "structure.max_level")) << outcome.output;
    EXPECT_TRUE(says(outcome, "more than 32 MiB")) << outcome.output;
  }
}

TEST_F(Limits, SceneAndLogAreRefused) {
  const Outcome scene = run("", " --set host_machine.memory_limit=1MiB");
  EXPECT_EQ(scene.status, 2);
  EXPECT_TRUE(says(scene, "the scene")) << scene.output;
  const Outcome log =
      run("", " --set image.width=4096 --set image.height=4096 --set host_machine.memory_limit=99MiB");
  EXPECT_EQ(log.status, 2);
  EXPECT_TRUE(says(log, "work log")) << log.output;
  const Outcome little = run("", " --set host_machine.memory_limit=1KiB");
  EXPECT_EQ(little.status, 2);
  EXPECT_TRUE(says(little, "less than 1 MiB")) << little.output;
}

TEST_F(Limits, APlanIsRefusedBeforeItsPointsAreRead) {
  write(file(),
        "[host_machine]\nmemory_limit = \"64 MiB\"\n[sweep.axes]\nmachine.nodes = { from = 1, to = 1000, "
        "steps = 1000 }\n"
        "host.latency_cycles = { from = 1, to = 1000, steps = 1000 }\n");
  const Outcome outcome = marti("sweep " + quoted(file()) + " --plan");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_TRUE(says(outcome, "the plan of 1000000 points takes about")) << outcome.output;
  EXPECT_TRUE(says(outcome, "host_machine.memory_limit: the plan of")) << outcome.output;
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

// Too little address space for a thread, for oneTBB's, for the scene, for all: never an abort.
TEST_F(Limits, LittleAddressSpaceIsNoAbort) {
  if (MARTI_SANITIZED) {
    GTEST_SKIP() << "a sanitizer takes terabytes of address space";
  }
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
    }
  }
  EXPECT_GE(done, 2);
}

// As a user who may have few processes: none at all for threads, one, two, ...
TEST_F(Limits, FewProcessesAreNoAbort) {
  if (getuid() != 0) {
    GTEST_SKIP() << "the limit of processes counts all of a user's: only root can be a user without any";
  }
  constexpr const char* other = "setpriv --reuid=54321 --regid=54321 --clear-groups ";
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
