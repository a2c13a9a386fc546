// Nodes whose work other threads do while they wait have the results of one thread.
#include "processors/node/work_ahead.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "tests/support/equal_results.h"
#include "tests/support/random_machine.h"

namespace marti::processors::node {

namespace {

// Machines as small as the random ones, of which no part is timed by itself.
replay::ReplayOptions with_helpers(unsigned helpers) {
  replay::ReplayOptions options;
  options.threads = 1 + helpers;
  options.parts = 1;
  options.fewest_nodes_of_threads = 0;
  return options;
}

RC_GTEST_PROP(WorkAhead, HasTheResultOfOneThread, (std::uint64_t seed)) {
  test::Random random(seed);
  const program::WorkLog log = test::small_log(random);
  machine::MachineConfig machine = test::random_machine(random, 40);
  test::add_random_second_level(random, machine);
  test::add_random_dram(random, machine);
  replay::ReplayOptions options = with_helpers(static_cast<unsigned>(test::pick(random, 1, 3)));
  const auto stripped = walk::StrippedLog::ways_of(machine) != 0 && test::pick(random, 0, 1) == 0
                            ? walk::StrippedLog::make(log, machine)
                            : nullptr;
  options.stripped = stripped.get();
  const replay::MachineResult alone = replay::replay(log, machine);
  const replay::MachineResult helped = replay::replay(log, machine, options);
  test::expect_equal(alone, helped);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  RC_ASSERT(alone.events == helped.events);
  RC_ASSERT(alone.host.requests == helped.host.requests);
  RC_CLASSIFY(why_not_ahead(machine) == nullptr);
  RC_CLASSIFY(stripped != nullptr);
}

// Counts the work of each node, which must come once between begin() and finish(), and by one thread.
class CountedWork final : public NodeWork {
 public:
  explicit CountedWork(std::uint32_t nodes) : begun(nodes), done(nodes) {}
  void work_ahead(std::uint32_t node, Ahead& ahead) override {
    ahead.time = ++done[node];
    if (node == faulty && done[node] == 3) {
      throw std::runtime_error("the third work of a node");
    }
  }
  void prepare_ahead(std::uint32_t /*node*/) const override {}

  std::vector<std::int64_t> begun;  // by the test
  std::vector<std::int64_t> done;
  std::uint32_t faulty = 0xffffffffU;
};

// Leaves `rounds` works of each node to the helpers, and takes each back after `lag` others were left to
// them.
void go_round(CountedWork& work, unsigned helpers, std::uint32_t lag, int rounds) {
  const auto nodes = static_cast<std::uint32_t>(work.begun.size());
  WorkAhead ahead(helpers, nodes, work);
  const WorkAhead::Team team(ahead);
  const auto finish = [&](std::uint32_t node) {
    ahead.finish(node);
    ASSERT_EQ(ahead.of(node).time, work.begun[node]);
  };
  std::uint64_t next = 0;
  for (; next < std::uint64_t{nodes} * static_cast<std::uint64_t>(rounds); ++next) {
    if (next >= lag) {
      finish(static_cast<std::uint32_t>((next - lag) % nodes));
    }
    const auto node = static_cast<std::uint32_t>(next % nodes);
    ++work.begun[node];
    ahead.begin(node);
  }
  for (std::uint64_t left = next - lag; left < next; ++left) {
    finish(static_cast<std::uint32_t>(left % nodes));
  }
  EXPECT_EQ(work.begun, work.done);
}

// With few nodes under way the helpers are late and get a rest; with many, their rings are full.
TEST(WorkAhead, IsDoneOnceWhetherHelpersAreInTimeOrNot) {
  for (const unsigned helpers : {1U, 2U, 3U}) {
    for (const std::uint32_t lag : {1U, 20U, 1000U}) {
      CountedWork work(1000);
      go_round(work, helpers, lag, 100);
    }
  }
}

TEST(WorkAhead, PassesOnWhatAHelperThrows) {
  CountedWork work(64);
  work.faulty = 5;
  WorkAhead ahead(1, 64, work);
  const WorkAhead::Team team(ahead);
  const auto round = [&](std::chrono::milliseconds pause) {
    for (std::uint32_t node = 0; node < 64; ++node) {
      ahead.begin(node);
    }
    std::this_thread::sleep_for(pause);
    for (std::uint32_t node = 0; node < 64; ++node) {
      ahead.finish(node);
    }
  };
  round(std::chrono::milliseconds(0));
  round(std::chrono::milliseconds(0));
  EXPECT_THROW(round(std::chrono::milliseconds(20)), std::runtime_error);
}

TEST(WorkAhead, IsForPlainNodesThatWaitForEachOther) {
  machine::MachineConfig machine;
  EXPECT_EQ(why_not_ahead(machine), nullptr);
  EXPECT_STREQ(replay::why_one_thread(machine, 1024), "it has few nodes");
  EXPECT_EQ(replay::why_one_thread(machine, 1), nullptr);
  machine.contexts = 2;
  EXPECT_STREQ(replay::why_one_thread(machine, 1), "a node has several reads under way");
  machine.contexts = 1;
  machine.placement = machine::Placement::replicated;
  EXPECT_STREQ(replay::why_one_thread(machine, 1), "no read of a node waits for another");
  machine.placement = machine::Placement::shared;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  EXPECT_STREQ(replay::why_one_thread(machine, 1), "no read of a node waits for another");
  machine.clusters = 4;
  machine.nodes = 4;
  EXPECT_EQ(replay::why_one_thread(machine, 1), nullptr);
}

}  // namespace

}  // namespace marti::processors::node
