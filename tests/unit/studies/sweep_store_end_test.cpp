// A store whose program is killed at any instant. Full disks are in tests/cli.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <random>

#include "studies/sweep/store/sweep_store.h"
#include "tests/support/temporary_directory.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace sweep;

namespace {

namespace fs = std::filesystem;
using test::made_plan;
using test::made_row;
using test::TemporaryDirectory;

constexpr std::size_t machines = 120;
constexpr int rounds_a_test = 5;

// Adds the missing machines in order; calls `tell` for each machine when it is committed.
template <class Tell>
void finish(const fs::path& file, const Tell& tell) {
  SweepStore store(file, made_plan(machines));
  const std::vector<bool> frames = store.frames_done();
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    if (!frames[frame]) {
      store.add_frame(frame, test::made_frame_row(frame), 1);
    }
  }
  const std::vector<bool> done = store.done();
  for (std::size_t machine = 0; machine < machines; ++machine) {
    if (!done[machine]) {
      store.add_result(machine, made_row(machine), 1);
      tell(machine);
    }
  }
  store.close();
}

// A child that finishes the store and says on the pipe what it has committed.
pid_t start_child(const fs::path& file, int pipe) {
  const pid_t child = fork();
  if (child != 0) {
    return child;
  }
  try {
    finish(file, [&](std::size_t machine) {
      const auto number = static_cast<std::uint32_t>(machine);
      if (write(pipe, &number, sizeof number) != sizeof number) {
        _exit(3);
      }
    });
  } catch (const std::exception&) {
    _exit(2);
  }
  _exit(0);
}

class SweepStoreKilled : public testing::TestWithParam<std::uint64_t> {};

TEST_P(SweepStoreKilled, LosesNothingThatWasCommitted) {
  const TemporaryDirectory directory;
  std::mt19937_64 random(GetParam());
  std::string expected;
  {
    const fs::path whole = directory.path() / "whole.sqlite";
    finish(whole, [](std::size_t /*machine*/) {});
    expected = test::dump(whole);
    ASSERT_NE(expected.find("integrity: ok"), std::string::npos);
  }
  int killed = 0;
  for (int round = 0; round < rounds_a_test; ++round) {
    const fs::path file = directory.path() / ("killed" + std::to_string(round) + ".sqlite");
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = start_child(file, ends[1]);
    ASSERT_GT(child, 0);
    close(ends[1]);
    // Some are killed while the plan is entered, most after some committed machines and a random while.
    const std::uint64_t heard_first = round % 5 == 0 ? 0 : random() % machines;
    std::uint32_t number = 0;
    std::size_t committed = 0;
    while (committed < heard_first && read(ends[0], &number, sizeof number) == sizeof number) {
      committed = number + 1;
    }
    usleep(static_cast<useconds_t>(random() % (round % 5 == 0 ? 20000 : 400)));
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    killed += WIFSIGNALED(status) ? 1 : 0;
    while (read(ends[0], &number, sizeof number) == sizeof number) {
      committed = number + 1;
    }
    close(ends[0]);
    {
      SweepStore store(file, made_plan(machines));
      const std::vector<bool> done = store.done();
      const auto first_missing =
          static_cast<std::size_t>(std::find(done.begin(), done.end(), false) - done.begin());
      EXPECT_GE(first_missing, committed) << "round " << round;
      EXPECT_EQ(std::find(done.begin() + static_cast<std::ptrdiff_t>(first_missing), done.end(), true),
                done.end());
      // Stored results are those that were given: a different result would be an InternalError.
      for (std::size_t machine = 0; machine < first_missing; ++machine) {
        EXPECT_NO_THROW(store.add_result(machine, made_row(machine), 1));
      }
    }
    finish(file, [](std::size_t /*machine*/) {});
    EXPECT_EQ(test::dump(file), expected) << "round " << round;
  }
  EXPECT_GT(killed, 1) << "the rounds hardly tested anything";
}
INSTANTIATE_TEST_SUITE_P(Seeds, SweepStoreKilled, testing::Range<std::uint64_t>(1, 7));

}  // namespace
}  // namespace marti::studies
