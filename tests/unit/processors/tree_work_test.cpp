// The least time of making a bounding volume hierarchy: by hand, and beside what machines do.
#include "processors/cost/tree_work.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "memory/dram_presets.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace cost;
using namespace machine;

namespace {

std::int64_t all(const OperationMix& mix) {
  return (mix.add + mix.multiply + mix.divide + mix.square_root + mix.compare + mix.integer + 500) / 1000;
}

// 5 splits of 1,000 references each, over 200 primitives in 40 branches.
TreeWork some_build() {
  TreeWork work;
  work.build.of_size(1000) = {5, 5000, 300, 700};
  work.triangles = 190;
  work.quadrics = 10;
  work.branches = 40;
  return work;
}

// Whose operations cost a cycle each, with clocks and bytes that are easy to divide by.
MachineConfig plain_machine() {
  MachineConfig machine;
  machine.nodes = 1;
  machine.clock = sim::Clock::from_period(1);
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.cache.cache.size = 4096;
  return machine;
}

TEST(TreeWork, OperationsOfABuildAddUpByHand) {
  MachineConfig machine = plain_machine();
  const BvhMixes& mixes = bvh_mixes();
  // Records of 2, 12 and 10 words, references of 7, entries of 1, and an operation for the address of each.
  const std::int64_t sum = 190 * (all(mixes.bounded) + 13) + 10 * (all(mixes.bounded) + 11) +
                           5000 * (all(mixes.sorted) + 8) + 300 * all(mixes.plane) + 700 * 16 + 40 * 3 +
                           200 * 2;
  EXPECT_EQ(least_time(some_build(), machine).compute, sum);
  machine.layout.leaf = memory::LeafLayout::inline_records;
  EXPECT_EQ(least_time(some_build(), machine).compute, sum - 200 * 2 + 190 * 13 + 10 * 11);
}

TEST(TreeWork, OperationsOfARefitAddUpByHand) {
  MachineConfig machine = plain_machine();
  const BvhMixes& mixes = bvh_mixes();
  TreeWork work;
  work.refits = true;
  work.triangles = 30;
  work.instances = 4;
  work.branches = 9;
  work.merged = 50;
  EXPECT_EQ(least_time(work, machine).compute, 30 * (all(mixes.bounded) + 13 + 2) +
                                                   4 * (all(mixes.placed) + 17 + 17) + 9 * (3 + 3) +
                                                   50 * all(mixes.merged));
  const LeastTime least = least_time(work, machine);
  EXPECT_EQ(least.read, 30U * (48 + 4) + 4 * 64 + 9 * 8);
  EXPECT_EQ(least.written, 4U * 64 + 9 * 8);
  machine.layout.leaf = memory::LeafLayout::inline_records;
  EXPECT_EQ(least_time(work, machine).read, 30U * 48 + 4 * 64 + 9 * 8);
  EXPECT_EQ(least_time({}, machine).all(), 0);
}

TEST(TreeWork, NodesLanesAndClocksDivideTheTime) {
  MachineConfig machine = plain_machine();
  machine.clock = sim::Clock::from_period(40);
  const sim::Ticks one = least_time(some_build(), machine).all();
  machine.clock = sim::Clock::from_period(20);
  EXPECT_EQ(least_time(some_build(), machine).all(), one / 2);
  machine.clock = sim::Clock::from_period(40);
  machine.nodes = 16;
  EXPECT_EQ(least_time(some_build(), machine).all(), (one / 40 + 15) / 16 * 40);
  machine.clusters = 3;  // each makes a copy
  EXPECT_EQ(least_time(some_build(), machine).all(), (one / 40 + 15) / 16 * 40);
  machine.kind = NodeKind::simt;
  machine.simt.lanes = 32;
  machine.simt.issue = 2;
  EXPECT_EQ(least_time(some_build(), machine).all(), (one / 40 + 1023) / 1024 * 40);
  machine.kind = NodeKind::core;
  machine.placement = Placement::replicated;  // each node makes its own
  EXPECT_EQ(least_time(some_build(), machine).compute, one);
}

TEST(TreeWork, LevelsFollowOneAnother) {
  MachineConfig machine = plain_machine();
  machine.nodes = most_nodes;
  TreeWork work = some_build();
  EXPECT_EQ(least_time(work, machine).compute, 1);
  work.build.levels = 9;
  EXPECT_EQ(least_time(work, machine).compute, 9 * (all(bvh_mixes().sorted) + 8));
  work = {.branches = 9, .refits = true, .levels = 4};
  EXPECT_EQ(least_time(work, machine).compute, 4 * (3 + 3));
  machine.nodes = 1;
  EXPECT_EQ(least_time(work, machine).compute, 9 * (3 + 3));
}

TEST(TreeWork, WhatCachesHoldNeedNotBeMoved) {
  MachineConfig machine = plain_machine();
  const std::uint64_t primitives = 190 * 48 + 10 * 40;
  const std::uint64_t made = 40 * 8 + 200 * 4;
  machine.cache.organisation = CacheOrganisation::none;
  LeastTime least = least_time(some_build(), machine);
  EXPECT_EQ(least.read, primitives + 5000 * 28);
  EXPECT_EQ(least.written, made + 700 * 28);
  // Of each of five nodes with 28,000 bytes of references 4,096 may be in the cache.
  machine.cache.organisation = CacheOrganisation::unified;
  least = least_time(some_build(), machine);
  EXPECT_EQ(least.read, primitives + 5000 * 28 - std::uint64_t{5} * 4096);
  EXPECT_EQ(least.written, made);
  machine.l2.sharing = SecondLevel::shared;
  machine.l2.cache.size = 10000;
  machine.nodes = 2;
  EXPECT_EQ(least_time(some_build(), machine).read,
            primitives + 5000 * 28 - 5 * (2 * std::uint64_t{4096} + 10000));
  machine.nodes = most_nodes;
  machine.cache.cache.size = std::uint64_t{1} << 60U;
  EXPECT_EQ(least_time(some_build(), machine).read, primitives);
  machine.nodes = 2;
  machine.cache.cache.size = 4096;
  machine.l2.sharing = SecondLevel::private_caches;
  EXPECT_EQ(least_time(some_build(), machine).read, primitives);
}

TEST(TreeWork, EachMemorySystemCarriesWhatItCan) {
  MachineConfig machine = plain_machine();
  EXPECT_EQ(least_transfer(8000, 1600, machine), 0);
  machine.interconnect = {.kind = memory::InterconnectKind::bus,
                          .clock = sim::Clock::from_period(100),
                          .width = 16,
                          .cycles_per_beat = 2};
  machine.banks = {.count = 4,
                   .interleave = 32,
                   .clock = sim::Clock::from_period(10),
                   .access_cycles = 4,
                   .busy_cycles = 3};
  EXPECT_EQ(least_transfer(8000, 1600, machine), 9600 / 16 * 2 * 100);
  machine.interconnect.kind = memory::InterconnectKind::crossbar;  // what is read, over four links
  EXPECT_EQ(least_transfer(8000, 1600, machine), 8000 / 4 / 16 * 2 * 100);
  machine.banks.clock = sim::Clock::from_period(1000);  // lines of 32 bytes, 75 from each bank
  EXPECT_EQ(least_transfer(8000, 1600, machine), 75 * 3 * 1000);
  memory::DramConfig dram = memory::dram_preset(std::size_t{0});
  machine.banks.dram = dram;
  const double seconds = 9.6e9 / dram.peak_bandwidth();
  EXPECT_NEAR(static_cast<double>(least_transfer(8'000'000'000, 1'600'000'000, machine)) * 1e-12, seconds,
              1e-6 * seconds);
  machine.placement = Placement::distributed;
  machine.nodes = 3;
  machine.distribution.interleave = 32;
  machine.local = {.clock = sim::Clock::from_period(7), .width = 8, .access_cycles = 5, .cycles_per_beat = 3};
  EXPECT_EQ(least_transfer(8000, 1600, machine), 100 * (5 + 4 * 3) * 7);
  machine.placement = Placement::replicated;
  EXPECT_EQ(least_transfer(8000, 1600, machine), 300 * (5 + 4 * 3) * 7);
}

// What nodes have read and written in a frame, none could have moved faster.
RC_GTEST_PROP(TreeWork, NoMachineMovesBytesInLess, (std::uint64_t seed)) {
  test::Random random(seed);
  const program::WorkLog log = test::random_log(random, 8, 8);
  MachineConfig machine = test::random_machine(random);
  test::add_random_dram(random, machine);
  const replay::MachineResult result = replay::replay(log, machine);
  RC_PRE(machine.placement != Placement::replicated);
  for (const replay::ClusterResult& cluster : result.clusters) {
    const auto bytes = static_cast<std::uint64_t>(cluster.interconnect.bytes);
    const std::uint64_t written = std::min<std::uint64_t>(
        bytes, static_cast<std::uint64_t>(cluster.interconnect.writes) * machine.layout.pixel_bytes);
    RC_ASSERT(least_transfer(bytes - written, written, machine) <= result.end);
  }
}

TEST(TreeWork, TimesBeyondAllBoundsAreRefused) {
  MachineConfig machine = plain_machine();
  machine.operations.compare = std::numeric_limits<std::int64_t>::max() / 100;
  EXPECT_THROW((void)least_time(some_build(), machine), sim::UserError);
}

}  // namespace
}  // namespace marti::processors
