// The space scheme against a second model, by hand, and against laws.
#include "processors/replay/space.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "processors/cost/step_time.h"
#include "sim/error.h"
#include "tests/support/logged_samples.h"
#include "tests/support/naive_space.h"
#include "tests/support/random_flow.h"
#include "tests/support/user_error.h"

namespace marti::processors {
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

WorkLog random_frame(test::Random& random) {
  const auto width = static_cast<std::uint32_t>(test::pick(random, 1, 9));
  const auto height = static_cast<std::uint32_t>(test::pick(random, 1, 9));
  switch (test::pick(random, 0, 3)) {
    case 0:
      return test::random_log(random, width, height);
    case 1:
      return test::random_tree_log(random, width, height);
    case 2:
      return test::random_ray_trees(random, width, height, 12, 4);
    default:
      return test::random_ray_trees(random, width, height, 5, 3, 3);
  }
}

template <class T>
std::vector<std::int64_t> values(const T& counts) {
  std::vector<std::int64_t> all;
  for (const auto& counter : T::counters()) {
    all.push_back(counts.*counter.member);
  }
  return all;
}

void expect_equal(const MachineResult& a, const MachineResult& b) {
  ASSERT_EQ(a.end, b.end);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    ASSERT_EQ(a.nodes[n].time, b.nodes[n].time) << "node " << n;
    ASSERT_EQ(values(a.nodes[n].steps), values(b.nodes[n].steps)) << "node " << n;
    ASSERT_EQ(a.nodes[n].references.hits, b.nodes[n].references.hits);
    ASSERT_EQ(a.nodes[n].references.misses, b.nodes[n].references.misses);
    ASSERT_EQ(values(a.nodes[n]), values(b.nodes[n])) << "node " << n;
    ASSERT_EQ(values(a.flow.nodes[n]), values(b.flow.nodes[n])) << "node " << n;
  }
  ASSERT_EQ(a.flow.networks.size(), b.flow.networks.size());
  for (std::size_t c = 0; c < a.flow.networks.size(); ++c) {
    ASSERT_EQ(values(a.flow.networks[c]), values(b.flow.networks[c]));
    ASSERT_EQ(values(a.flow.networks[c].waits), values(b.flow.networks[c].waits));
  }
  ASSERT_EQ(values(a.host), values(b.host));
  ASSERT_EQ(a.flow.rays, b.flow.rays);
  ASSERT_EQ(a.flow.collected, b.flow.collected);
  ASSERT_EQ(a.flow.most_in_flight, b.flow.most_in_flight);
}

RC_GTEST_PROP(Space, EqualsASecondModelInEveryCounter, (std::uint64_t seed)) {
  test::Random random(seed);
  for (int repeat = 0; repeat < 4; ++repeat) {
    const WorkLog log = random_frame(random);
    MachineConfig machine = random_space(random);
    if (machine.cache.cache.replacement == memory::Replacement::random) {
      machine.cache.cache.replacement = memory::Replacement::fifo;
    }
    expect_equal(replay(log, machine), test::NaiveSpace(log, machine).run());
    RC_ASSERT(!::testing::Test::HasFatalFailure());
  }
}

RC_GTEST_PROP(Space, RunningAheadEqualsAnEventForEveryReference, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = random_frame(random);
  const MachineConfig machine = random_space(random);
  const MachineResult ahead = replay(log, machine);
  const MachineResult stepped = replay(log, machine, {.step_by_step = true});
  expect_equal(ahead, stepped);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  RC_ASSERT(ahead.events <= stepped.events);
}

RC_GTEST_PROP(Space, TheOrderOfTheFirstEventsDoesNotMatter, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = random_frame(random);
  const MachineConfig machine = random_space(random);
  expect_equal(replay(log, machine), replay(log, machine, {.start_seed = random() | 1U}));
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

RC_GTEST_PROP(Space, ScalingEveryDurationScalesEveryTimeExactly, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = random_frame(random);
  const MachineConfig machine = random_space(random);
  MachineConfig slow = machine;
  constexpr std::int64_t scale = 1'000'003;
  for (sim::Clock* clock : {&slow.clock, &slow.host.clock, &slow.local.clock, &slow.network.clock}) {
    *clock = sim::Clock::from_period(clock->period() * scale);
  }
  const MachineResult base = replay(log, machine);
  const MachineResult scaled = replay(log, slow);
  RC_ASSERT(scaled.end == base.end * scale);
  RC_ASSERT(scaled.events == base.events);
  for (std::size_t n = 0; n < base.nodes.size(); ++n) {
    for (std::size_t i = 0; i < activities; ++i) {
      RC_ASSERT(scaled.nodes[n].time[i] == base.nodes[n].time[i] * scale);
    }
  }
}

// Rays and messages, node by node. Queues of one slot and one ray at a time are among these machines.
RC_GTEST_PROP(Space, WhatComesToANodeLeavesIt, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = random_frame(random);
  const MachineConfig machine = random_space(random);
  const MachineResult result = replay(log, machine);
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
  const MachineResult result = replay(log, machine);
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
  const WorkLog log = random_frame(random);
  MachineConfig machine = random_space(random);
  machine.clusters = machine.nodes = 1;
  machine.space.queue = 100;
  machine.space.in_flight = 100;
  // The host keeps the queue filled.
  machine.host.latency_cycles = machine.host.occupancy_cycles = 0;
  machine.network.kind = memory::NetworkKind::ideal;
  machine.network.hop_cycles = machine.network.cycles_per_beat = 0;
  const MachineResult result = replay(log, machine);
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

/// A root with two leaves of one triangle: leaf 1 is node 0's and leaf 2 is node 1's.
WorkLog two_leaves(std::vector<std::uint32_t> words, std::vector<std::uint32_t> begin) {
  WorkLog log;
  log.height = 1;
  log.width = static_cast<std::uint32_t>(begin.size()) - 1;
  log.primitives = 1;
  log.materials = 1;
  log.texture_begin = {0};
  log.topology.nodes = {{1, 2, 1, false}, {0, 1, 2, true}, {1, 1, 2, true}};
  log.topology.entries = {0, 0};
  log.rows = {{std::move(words), std::move(begin)}};
  return log;
}

/// Two nodes of one tick a cycle whose every reference takes 10 ticks; messages take 100.
MachineConfig two_nodes() {
  MachineConfig machine;
  machine.scheme = Scheme::space;
  machine.nodes = 2;
  machine.clock = machine.local.clock = machine.network.clock = machine.host.clock =
      sim::Clock::from_period(1);
  machine.cache.organisation = CacheOrganisation::none;
  machine.local.access_cycles = 10;
  machine.local.cycles_per_beat = 0;
  machine.host.latency_cycles = 0;
  machine.messages.send_cycles = 7;
  machine.messages.receive_cycles = 5;
  machine.network.kind = memory::NetworkKind::ideal;
  machine.network.hop_cycles = 100;
  machine.network.cycles_per_beat = 0;
  machine.space.level = 2;
  return machine;
}

using test::ray_word;

constexpr std::uint32_t reference = 10;

// Its record, its list, and a triangle of two references.
sim::Ticks leaf_time(const StepTicks& t) { return t.leaf + t.test + 4 * reference; }

sim::Ticks time_of(const NodeStatistics& node, Activity activity) {
  return node.time[static_cast<std::size_t>(activity)];
}

TEST(Space, TwoNodesByHand) {
  // The camera ray goes from leaf 1 to leaf 2 and is shaded there; its shadow ray goes back to leaf 1 and
  // reaches the light.
  const WorkLog log =
      two_leaves({ray_word(RayKind::camera, 0), make_word(Step::branch, 0), make_word(Step::leaf, 1),
                  make_word(Step::leaf, 2), make_word(Step::shade, 0), ray_word(RayKind::shadow, 1),
                  make_word(Step::branch, 0), make_word(Step::leaf, 1), make_word(Step::light, 0)},
                 {0, 9});
  const MachineConfig machine = two_nodes();
  const StepTicks t = step_ticks(machine, log);
  const MachineResult result = replay(log, machine);

  const sim::Ticks first = 100 + 5 + t.ray[0] + t.branch + reference + leaf_time(t) + 7;
  // A material record is two references.
  const sim::Ticks hit = first + 100 + 5 + leaf_time(t) + t.shade + 2 * reference + 7;
  const sim::Ticks left = hit + t.ray[1] + t.branch + reference + 7;
  const sim::Ticks lit = left + 100 + 5 + leaf_time(t) + t.light + 7;
  EXPECT_EQ(result.end, lit + 100);
  EXPECT_EQ(result.nodes[0].finish, lit);
  EXPECT_EQ(result.nodes[1].finish, left);
  EXPECT_EQ(time_of(result.nodes[0], Activity::message_wait), 100 + (left + 100 - first));
  EXPECT_EQ(time_of(result.nodes[0], Activity::idle), 100);
  EXPECT_EQ(time_of(result.nodes[1], Activity::message_wait), first + 100);
  EXPECT_EQ(time_of(result.nodes[1], Activity::idle), lit + 100 - left);
  EXPECT_EQ(time_of(result.nodes[1], Activity::messaging), 5 + 7 + 7);
  EXPECT_EQ(values(result.flow.nodes[0]), (std::vector<std::int64_t>{2, 0, 1, 1, 1, 64 + 16, 1, 0, 0}));
  EXPECT_EQ(values(result.flow.nodes[1]), (std::vector<std::int64_t>{1, 1, 1, 1, 1, 64 + 16, 1, 0, 0}));
  EXPECT_EQ(result.flow.most_in_flight, 1);
}

TEST(Space, TheHostWaitsForSlotsToo) {
  // Three rays go from leaf 1 to leaf 2, where a slow one keeps the only slot.
  const std::uint32_t camera = ray_word(RayKind::camera, 0);
  const std::uint32_t near = make_word(Step::leaf, 1);
  const std::uint32_t far = make_word(Step::leaf, 2);
  const WorkLog log = two_leaves({camera, near, far, camera, near, far, camera, near, far}, {0, 3, 6, 9});
  MachineConfig machine = two_nodes();
  machine.space.queue = 1;
  machine.space.in_flight = 3;
  machine.messages = {64, 16, 0, 0};
  machine.network.hop_cycles = 1000;
  const StepTicks t = step_ticks(machine, log);
  const sim::Ticks near_time = t.ray[0] + leaf_time(t);
  ASSERT_LT(near_time, 1000);
  const MachineResult result = replay(log, machine);
  // The host's second and third ray wait for node 0's slot, 1000 under way each. The ways to both nodes
  // overlap: node 1 takes each ray 1000 after node 0 has done it.
  EXPECT_EQ(result.nodes[0].finish, 3 * 1000 + near_time);
  EXPECT_EQ(result.nodes[1].finish, 3 * 1000 + near_time + 1000 + leaf_time(t));
  EXPECT_EQ(result.flow.nodes[0].longest_queue, 1);
  // Node 0 is done with the next ray at the very tick at which node 1 takes the one before: what is sent
  // comes before what is taken, so the ray is set aside for no time.
  EXPECT_EQ(result.flow.nodes[0].most_set_aside, 1);

  // With room before the nodes all are under way together.
  machine.space.queue = 3;
  const MachineResult wide = replay(log, machine);
  EXPECT_EQ(wide.flow.nodes[0].most_set_aside, 0);
  EXPECT_EQ(wide.flow.nodes[0].queued, near_time + 2 * near_time);
  EXPECT_EQ(wide.nodes[0].finish, 1000 + 3 * near_time);
}

TEST(Space, RaysSetAsideGoWhenASlotIsFree) {
  // One camera ray with two lights: its shadow rays both leave for node 1, which has one slot.
  const WorkLog log =
      two_leaves({ray_word(RayKind::camera, 0), make_word(Step::leaf, 1), make_word(Step::shade, 0),
                  ray_word(RayKind::shadow, 1), make_word(Step::leaf, 2), ray_word(RayKind::shadow, 1),
                  make_word(Step::leaf, 2), ray_word(RayKind::shadow, 1), make_word(Step::leaf, 1)},
                 {0, 9});
  MachineConfig machine = two_nodes();
  machine.space.queue = 1;
  machine.messages = {64, 16, 0, 0};
  const StepTicks t = step_ticks(machine, log);
  const MachineResult result = replay(log, machine);
  const sim::Ticks hit = 100 + t.ray[0] + leaf_time(t) + t.shade + 2 * reference;
  EXPECT_EQ(result.nodes[0].finish, hit + 3 * t.ray[1] + leaf_time(t));
  // The first shadow ray leaves at hit + ray and is taken 100 later; only then does the second leave.
  EXPECT_EQ(result.nodes[1].finish, hit + t.ray[1] + 100 + 100 + leaf_time(t));
  EXPECT_EQ(result.flow.nodes[0].most_set_aside, 1);
  EXPECT_EQ(result.flow.nodes[0].made, 3);
  EXPECT_EQ(result.flow.collected, 1);  // no shadow ray reached its light
  EXPECT_EQ(result.flow.most_in_flight, 3);
}

TEST(Space, ImpossibleMachinesAreRefused) {
  const WorkLog log = two_leaves({ray_word(RayKind::camera, 0)}, {0, 1});
  MachineConfig machine = two_nodes();
  machine.space.level = 0;
  EXPECT_EQ(test::user_error_of([&] { (void)replay(log, machine); }), "space.level: the root is level 1");
  machine = two_nodes();
  machine.space.queue = 0;
  EXPECT_NE(test::user_error_of([&] { (void)replay(log, machine); }).find("space.queue"), std::string::npos);
  machine = two_nodes();
  machine.local.width = 0;
  EXPECT_NE(test::user_error_of([&] { (void)replay(log, machine); }).find("local memory"), std::string::npos);
}

}  // namespace
}  // namespace marti::processors
