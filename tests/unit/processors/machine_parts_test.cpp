// Machines that several threads time in parts have the results of one thread.
#include "processors/replay/machine_parts.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/work_meter.h"
#include "tests/support/equal_results.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace machine;
using namespace replay;

namespace {

// Several clusters, most of them with a host that answers after a while.
MachineConfig clustered_machine(test::Random& random) {
  MachineConfig machine = test::random_machine(random, 40);
  machine.clusters = static_cast<std::uint32_t>(test::pick(random, 2, 9));
  machine.nodes = static_cast<std::uint32_t>(test::pick(random, 1, 6));
  machine.host.latency_cycles = test::pick(random, 0, 40);
  test::add_random_second_level(random, machine);
  test::add_random_dram(random, machine);
  return machine;
}

// Only some on several threads: machines as small as these let them wait for each other most of the time.
MachineResult in_parts(const program::WorkLog& log, const MachineConfig& machine, unsigned parts,
                       ReplayOptions options = {}) {
  options.parts = parts;
  options.fewest_nodes_of_threads = 0;
  return replay::replay(log, machine, options);
}

// How many parts there are, and where they begin, is nowhere in a result; nor is the number of events one of
// how they were divided.
RC_GTEST_PROP(MachineParts, HaveTheResultOfOneThread, (std::uint64_t seed)) {
  test::Random random(seed);
  const program::WorkLog log = test::small_log(random);
  const MachineConfig machine = clustered_machine(random);
  const auto parts = static_cast<unsigned>(test::pick(random, 2, 5));
  ReplayOptions options;
  options.threads = test::pick(random, 0, 9) == 0 ? 2 : 1;
  options.step_by_step = test::pick(random, 0, 4) == 0;
  options.packet_seed = static_cast<std::uint64_t>(test::pick(random, 0, 2));
  const MachineResult alone = replay::replay(log, machine, options);
  const MachineResult together = in_parts(log, machine, parts, options);
  test::expect_equal(alone, together);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  RC_ASSERT(alone.events == together.events);
  RC_ASSERT(alone.copies == together.copies);
  RC_ASSERT(alone.host.requests == together.host.requests);
  RC_ASSERT(alone.host.busy == together.host.busy);
  RC_CLASSIFY(why_no_parts(machine, 0) == nullptr);
  RC_CLASSIFY(machine.host.assignment == Assignment::dynamic);
}

TEST(MachineParts, AreWalkedFromAStrippedLogToo) {
  test::Random random(7);
  int stripped_ones = 0;
  for (int i = 0; i < 200; ++i) {
    const program::WorkLog log = test::small_log(random);
    const MachineConfig machine = clustered_machine(random);
    if (walk::StrippedLog::ways_of(machine) == 0) {
      continue;
    }
    const auto stripped = walk::StrippedLog::make(log, machine);
    ReplayOptions options;
    options.stripped = stripped.get();
    test::expect_equal(replay::replay(log, machine), in_parts(log, machine, 3, options));
    ASSERT_FALSE(HasFatalFailure()) << "machine " << i;
    ++stripped_ones;
  }
  EXPECT_GT(stripped_ones, 20);
}

TEST(MachineParts, AreThoseOfMachinesWithClustersAndAHostThatTakesTime) {
  MachineConfig machine;
  machine.clusters = 4;
  machine.nodes = 8;
  EXPECT_EQ(why_no_parts(machine, 32), nullptr);
  EXPECT_STREQ(why_no_parts(machine, 33), "it has few nodes");
  machine.host.latency_cycles = 0;
  EXPECT_STREQ(why_no_parts(machine, 0), "the host answers at once");
  machine.host.assignment = Assignment::interleaved;
  EXPECT_EQ(why_no_parts(machine, 0), nullptr);
  machine.cache.cache.replacement = memory::Replacement::random;
  EXPECT_STREQ(why_no_parts(machine, 0), "its caches replace lines at random");
  machine.cache.cache.replacement = memory::Replacement::lru;
  machine.clusters = 1;
  EXPECT_STREQ(why_no_parts(machine, 0), "its nodes share a memory or a network");
  machine.clusters = 4;
  machine.scheme = Scheme::pipeline;
  EXPECT_STREQ(why_no_parts(machine, 0), "rays move between nodes");
}

// Stopping the meter ends all threads.
TEST(MachineParts, StopWhenTheMeterIsStopped) {
  test::Random random(3);
  const program::WorkLog log = test::small_log(random);
  MachineConfig machine;
  machine.clusters = 4;
  machine.nodes = 2;
  sim::WorkMeter meter;
  meter.stop();
  for (const Assignment assignment : {Assignment::dynamic, Assignment::interleaved}) {
    machine.host.assignment = assignment;
    ReplayOptions options;
    options.meter = &meter;
    options.threads = 4;
    EXPECT_THROW((void)in_parts(log, machine, 4, options), sim::Stopped);
  }
}

}  // namespace

}  // namespace marti::processors
