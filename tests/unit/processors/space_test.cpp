// The space scheme against a second model and against laws. The laws of all machines are in tests/contract.
#include "processors/replay/space.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "processors/cost/step_time.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/naive_space.h"
#include "tests/support/random_flow.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace flow;
using namespace machine;
using namespace program;
using namespace replay;

namespace {

MachineConfig random_space(test::Random& random) {
  MachineConfig machine = test::random_machine(random, 9);
  test::make_random_space(random, machine);
  if (random() % 8 == 0) {
    // Nothing takes any time: all events are at the same tick.
    machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
    machine.cache.hit_cycles = machine.local.access_cycles = machine.local.cycles_per_beat = 0;
    machine.messages.send_cycles = machine.messages.receive_cycles = 0;
    machine.network.cycles_per_beat = machine.network.hop_cycles = 0;
    machine.host.latency_cycles = machine.host.occupancy_cycles = 0;
  }
  return machine;
}

RC_GTEST_PROP(Space, EqualsASecondModelInEveryCounter, (std::uint64_t seed)) {
  test::Random random(seed);
  for (int repeat = 0; repeat < 4; ++repeat) {
    const WorkLog log = test::any_log(random);
    MachineConfig machine = random_space(random);
    if (machine.cache.cache.replacement == memory::Replacement::random) {
      machine.cache.cache.replacement = memory::Replacement::fifo;
    }
    machine.count = {machine.cache.organisation != CacheOrganisation::none, true, true};
    const MachineResult result = replay::replay(log, machine);
    test::NaiveCounts counts(machine);
    MachineResult plain = test::NaiveSpace(log, machine, &counts).run();
    counts.expect(result.counts, true);
    test::expect_equal(replay::replay(log, test::without_counting(machine)), result);
    plain.clusters = result.clusters;  // no node uses a memory that is shared
    test::expect_equal(result, plain);
    RC_ASSERT(!::testing::Test::HasFailure());
  }
}

// Rays and messages, node by node. Queues of one slot and one ray at a time are among these machines.
RC_GTEST_PROP(Space, WhatComesToANodeLeavesIt, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::any_log(random);
  const MachineConfig machine = random_space(random);
  const MachineResult result = replay::replay(log, machine);
  std::int64_t taken = 0;
  std::int64_t passed_on = 0;
  for (const FlowCounts& node : result.flow.nodes) {
    RC_ASSERT(node.taken + node.made == node.passed_on + node.ended);
    RC_ASSERT(node.longest_queue <= machine.space.queue);
    taken += node.taken;
    passed_on += node.passed_on;
  }
  RC_ASSERT(taken == passed_on + result.host.requests);
  // At most as many pixels as rays may be in flight, and of each at most all of its rays.
  std::size_t most_rays = 0;
  std::vector<LoggedRay> rays;
  for (std::uint32_t pixel = 0; pixel < log.width * log.height; ++pixel) {
    rays_of_sample(log.pixel(pixel % log.width, pixel / log.width), rays);
    most_rays = std::max(most_rays, rays.size());
  }
  RC_ASSERT(result.flow.most_in_flight <= static_cast<std::int64_t>(std::uint64_t{admission_limit(machine)} *
                                                                    machine.clusters * most_rays));
}

RC_GTEST_PROP(Space, WithOneRegionOnlyTheHostSends, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_tree_log(random, 6, 6);
  MachineConfig machine = random_space(random);
  machine.space.level = 1;
  const MachineResult result = replay::replay(log, machine);
  std::int64_t messages = 0;
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    messages += network.messages;
  }
  const accel::TopologyNode& root = log.topology.nodes[0];
  const bool empty = root.leaf && root.count == 0;
  RC_ASSERT(result.flow.regions == (empty ? 0U : 1U));
  RC_ASSERT(result.flow.top_nodes == (empty ? 1U : 0U));
  RC_ASSERT(result.flow.duplicated_primitives == 0);
  RC_ASSERT(messages == result.host.requests + result.flow.collected);
}

RC_GTEST_PROP(Space, OneNodeTakesTheSumOfAllCosts, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::any_log(random);
  MachineConfig machine = random_space(random);
  machine.clusters = machine.nodes = 1;
  machine.space.queue = 100;
  machine.space.in_flight = 100;
  // The host keeps the queue filled.
  machine.host.latency_cycles = machine.host.occupancy_cycles = 0;
  machine.network.kind = memory::NetworkKind::ideal;
  machine.network.hop_cycles = machine.network.cycles_per_beat = 0;
  const MachineResult result = replay::replay(log, machine);
  const NodeStatistics& node = result.nodes[0];
  TimeDivision costs{};
  add_counted_time(step_ticks(machine, log), node.steps, node.references.all_hits(), costs);
  const auto messages = machine.messages.receive_cycles * result.host.requests +
                        machine.messages.send_cycles * result.flow.collected;
  costs[static_cast<std::size_t>(Activity::messaging)] = machine.clock.cycles(messages);
  for (const Activity memory : {Activity::transfer, Activity::bank_access}) {
    costs[static_cast<std::size_t>(memory)] = node.time[static_cast<std::size_t>(memory)];
  }
  RC_ASSERT(node.references.all_misses() * machine.local.clock.cycles(machine.local.access_cycles) ==
            costs[static_cast<std::size_t>(Activity::bank_access)]);
  RC_ASSERT(node.time == costs);
  RC_ASSERT(result.end == sum_of(costs));
  RC_ASSERT(result.flow.memory_bytes[0] <= result.database_bytes);
}

TEST(Space, ImpossibleMachinesAreRefused) {
  test::Random random(1);
  const WorkLog log = test::random_tree_log(random, 2, 2);
  const auto refusal_of = [&](void (*spoil)(MachineConfig&)) {
    MachineConfig machine;
    machine.scheme = Scheme::space;
    spoil(machine);
    return test::user_error_of([&] { (void)replay::replay(log, machine); });
  };
  EXPECT_EQ(refusal_of([](MachineConfig& m) { m.space.level = 0; }), "space.level: the root is level 1");
  EXPECT_NE(refusal_of([](MachineConfig& m) { m.space.queue = 0; }).find("space.queue"), std::string::npos);
  EXPECT_NE(refusal_of([](MachineConfig& m) { m.local.width = 0; }).find("local memory"), std::string::npos);
}

}  // namespace
}  // namespace marti::processors
