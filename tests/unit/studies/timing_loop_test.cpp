// The loop of a sweep beside a replay of each machine by itself.
#include "studies/sweep/work/timing_loop.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

#include "processors/replay/replay.h"
#include "tests/support/temporary_directory.h"
#include "tests/unit/studies/sweep_tables.h"

namespace marti::studies {

using namespace sweep;

namespace {

// Four frames of two sizes; machines whose logs are stripped in one pass, or not at all, alone and together.
SweepPlan some_plan() {
  return test::plan_of(R"(
[scene]
source = "teapot:2"
[image]
height = 12
[sweep.axes]
image.width = [12, 40]
image.max_depth = [1, 2]
machine.nodes = [1, 3]
cache.ways = [1, 2, 4]
cache.line = ["16 B", "32 B"]
cache.replacement = ["lru", "fifo"]
interconnect.width = [31, 32]
)");
}

// What each machine's replay gives by itself, without a stripped log.
std::vector<SweepRow> rows_one_by_one(const SweepPlan& plan) {
  std::map<std::size_t, FrameLog> frames;
  std::vector<SweepRow> rows;
  for (const SweepMachine& machine : plan.machines) {
    const auto [frame, is_new] = frames.try_emplace(machine.frame);
    if (is_new) {
      frame->second = trace_frame(plan, machine.frame);
    }
    processors::replay::ReplayOptions options;
    options.keep_read_events = true;
    rows.push_back(
        sweep_row(machine.config, processors::replay::replay(*frame->second.log, machine.config, options)));
  }
  return rows;
}

class TimingLoop : public testing::TestWithParam<unsigned> {};

// Of a plan some of which is done already, with room for one log or for all.
TEST_P(TimingLoop, TimesWhatIsLeftAsOneByOne) {
  const SweepPlan plan = some_plan();
  ASSERT_EQ(plan.frames.size(), 4U);
  const std::vector<SweepRow> expected = rows_one_by_one(plan);
  std::mt19937_64 random(GetParam());
  for (const std::uint64_t limit : {std::uint64_t{1} << 20U, std::uint64_t{1} << 30U}) {
    const test::TemporaryDirectory directory;
    SweepStore store(directory.path() / "results.sqlite", plan);
    for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
      if (plan.machines[machine].frame == 1 || random() % 4 == 0) {
        store.add_result(machine, expected[machine], 1);
      }
    }
    Progress progress({.quiet = true});
    SweepResults results(plan, store, progress);
    const TracedFrame last = time_machines(plan, {store.done(), store.frames_done()},
                                           sim::MemoryBudget(limit), GetParam(), results);
    EXPECT_EQ(results.saved(), plan.machines.size());
    EXPECT_EQ(store.frames_done(), std::vector<bool>(4, true)) << "also that of which no machine was left";
    EXPECT_EQ(last.number, 3U);
    ASSERT_NE(last.log, nullptr);
    EXPECT_EQ(last.log->row, store.find_frame(3));
    // Each row that is added again must be equal, or the store refuses it.
    for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
      EXPECT_NO_THROW(store.add_result(machine, expected[machine], 1)) << machine;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Threads, TimingLoop, testing::Values(1U, 2U, 5U));

TEST(TimingLoop, SaysWhichMachineHasNoRoom) {
  SweepPlan plan = some_plan();
  plan.machines.back().config.nodes = 1U << 24U;
  const test::TemporaryDirectory directory;
  SweepStore store(directory.path() / "results.sqlite", plan);
  Progress progress({.quiet = true});
  SweepResults results(plan, store, progress);
  try {
    time_machines(plan, {store.done(), store.frames_done()}, sim::MemoryBudget(std::uint64_t{1} << 26U), 2,
                  results);
    FAIL() << "it was timed";
  } catch (const sim::UserError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("lower machine.nodes"), std::string::npos) << message;
    EXPECT_NE(message.find("(the point "), std::string::npos) << message;
    EXPECT_NE(message.find(", machine.nodes = 3, "), std::string::npos) << message;
    EXPECT_TRUE(message.ends_with(" on teapot:2)")) << message;
  }
}

}  // namespace
}  // namespace marti::studies
