// Replaying only some packets: exact where it is all of them; all laws hold.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

void expect_equal(const MachineResult& a, const MachineResult& b) {
  test::expect_equal(a, b);
  ASSERT_EQ(a.events, b.events);
}

// A random machine that a sample can be taken of.
MachineConfig random_sampled(test::Random& random) {
  MachineConfig machine = test::random_machine(random);
  machine.host.assignment = Assignment::dynamic;
  machine.build.sharing = Sharing::given;
  machine.count = {};
  machine.contexts = 1;
  machine.prefetch = {};
  machine.l2 = {};
  return machine;
}

std::vector<std::uint64_t> all_packets(std::uint64_t packets) {
  std::vector<std::uint64_t> all(packets);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

RC_GTEST_PROP(Inexact, AStrippedLogGivesTheSameSample, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  const MachineConfig machine = random_sampled(random);
  const auto stripped = StrippedLog::make(log, machine);
  if (stripped == nullptr) {
    return;
  }
  const std::uint64_t packets = PacketList(log.width, log.height, machine.packets).size();
  std::vector<std::uint64_t> some = all_packets(packets);
  std::erase_if(some, [&](std::uint64_t packet) { return packet != 0 && test::pick(random, 0, 2) != 0; });
  for (const std::uint64_t warm_up : {std::uint64_t{0}, std::uint64_t{1}, PacketSample::all_before}) {
    const PacketSample sample(some, packets, warm_up);
    const MachineResult whole = replay::replay(log, machine, {.sample = &sample});
    const MachineResult less = replay::replay(log, machine, {.stripped = stripped.get(), .sample = &sample});
    expect_equal(whole, less);
    RC_ASSERT(!::testing::Test::HasFatalFailure());
    RC_ASSERT(whole.packet_figures == less.packet_figures);
  }
}

RC_GTEST_PROP(Inexact, ASampleOfAllPacketsIsExact, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  const MachineConfig machine = random_sampled(random);
  const std::uint64_t packets = PacketList(log.width, log.height, machine.packets).size();
  const MachineResult exact = replay::replay(log, machine, {.keep_read_events = true});
  for (const std::uint64_t warm_up : {std::uint64_t{0}, std::uint64_t{1}, PacketSample::all_before}) {
    const PacketSample sample(all_packets(packets), packets, warm_up);
    const MachineResult sampled = replay::replay(log, machine, {.sample = &sample});
    expect_equal(exact, sampled);
    RC_ASSERT(!::testing::Test::HasFatalFailure());
    // The packets' figures add up to those of the nodes.
    PacketFigures sum;
    for (const PacketFigures& figures : sampled.packet_figures) {
      sum.time += figures.time;
      sum.references += figures.references;
      sum.misses += figures.misses;
    }
    const auto time = sampled.time();
    sim::Ticks worked = 0;
    for (const NodeStatistics& node : sampled.nodes) {
      worked += node.finish;
    }
    RC_ASSERT(sum.time == worked - time[static_cast<std::size_t>(Activity::dispatch_wait)]);
    RC_ASSERT(sum.references == exact.references().references());
    RC_ASSERT(sum.misses == exact.references().all_misses());
  }
}

RC_GTEST_PROP(Inexact, ASampleIsAFrameOfItsPackets, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  const MachineConfig machine = random_sampled(random);
  const std::uint64_t packets = PacketList(log.width, log.height, machine.packets).size();
  std::vector<std::uint64_t> chosen;
  for (std::uint64_t packet = 0; packet < packets; ++packet) {
    if (test::pick(random, 0, 2) == 0) {
      chosen.push_back(packet);
    }
  }
  RC_PRE(!chosen.empty());
  const PacketSample cold(chosen, packets, 0);
  const PacketSample warm(chosen, packets, PacketSample::all_before);
  const MachineResult first = replay::replay(log, machine, {.sample = &cold});
  const MachineResult second = replay::replay(log, machine, {.sample = &warm});
  RC_ASSERT(first.packets == chosen.size());
  RC_ASSERT(first.pixels == second.pixels);
  // The references do not depend on warming.
  RC_ASSERT(first.references().references() == second.references().references());
  RC_ASSERT(first.steps().tests == second.steps().tests);
}

// One node meets the packets in their order: fully warmed, each misses exactly what it misses in the frame.
RC_GTEST_PROP(Inexact, FullWarmingOfOneNodeGivesEachPacketsOwnMisses, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  MachineConfig machine = random_sampled(random);
  machine.clusters = 1;
  machine.nodes = 1;
  const std::uint64_t packets = PacketList(log.width, log.height, machine.packets).size();
  const PacketSample all(all_packets(packets), packets, 0);
  const MachineResult exact = replay::replay(log, machine, {.sample = &all});
  std::vector<std::uint64_t> chosen;
  for (std::uint64_t packet = 0; packet < packets; ++packet) {
    if (test::pick(random, 0, 1) == 0) {
      chosen.push_back(packet);
    }
  }
  RC_PRE(!chosen.empty());
  const PacketSample part(chosen, packets, PacketSample::all_before);
  const MachineResult sampled = replay::replay(log, machine, {.sample = &part});
  RC_ASSERT(sampled.packet_figures.size() == chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    RC_ASSERT(sampled.packet_figures[i].misses == exact.packet_figures[chosen[i]].misses);
    RC_ASSERT(sampled.packet_figures[i].references == exact.packet_figures[chosen[i]].references);
  }
}

TEST(Inexact, ANodeWarmsWithThePacketsItWouldHaveHad) {
  const PacketSample sample({2, 7, 12}, 20, PacketSample::all_before);
  const auto warmed = [&](std::uint64_t last, std::uint64_t next, std::uint64_t nodes) {
    std::vector<std::uint64_t> packets;
    sample.for_each_warmed(last, next, nodes, [&](std::uint64_t packet) { packets.push_back(packet); });
    return packets;
  };
  EXPECT_EQ(warmed(0, 2, 1), (std::vector<std::uint64_t>{0, 1}));
  EXPECT_EQ(warmed(3, 7, 1), (std::vector<std::uint64_t>{3, 4, 5, 6}));
  EXPECT_EQ(warmed(0, 2, 64), (std::vector<std::uint64_t>{}));
}

// One packet of each round, any of it: not the same place in every round.
TEST(Inexact, OfEachRoundANodeWarmsWithAnyPacket) {
  constexpr std::uint64_t nodes = 64;
  constexpr std::uint64_t rounds = 200;
  constexpr std::uint64_t next = nodes * rounds + 7;
  const PacketSample sample({next}, next + 1, PacketSample::all_before);
  std::vector<std::uint64_t> warmed;
  sample.for_each_warmed(0, next, nodes, [&](std::uint64_t packet) { warmed.push_back(packet); });
  ASSERT_EQ(warmed.size(), rounds);
  EXPECT_TRUE(std::is_sorted(warmed.begin(), warmed.end()));
  std::set<std::uint64_t> places;
  for (std::size_t i = 0; i < warmed.size(); ++i) {
    const std::uint64_t middle = next - (rounds - i) * nodes;
    EXPECT_LT(warmed[i], next);
    EXPECT_LE(warmed[i], middle + nodes / 2);
    EXPECT_GE(warmed[i] + nodes / 2, middle);
    places.insert(warmed[i] % nodes);
  }
  EXPECT_GT(places.size(), 50U);
}

TEST(Inexact, MachinesThatCannotBeSampledAreRefused) {
  test::Random random(1);
  const WorkLog log = test::small_log(random);
  const MachineConfig machine = random_sampled(random);
  const std::uint64_t packets = PacketList(log.width, log.height, machine.packets).size();
  const PacketSample sample({0}, packets, 0);
  const auto refused = [&](auto change) {
    MachineConfig other = machine;
    change(other);
    EXPECT_THROW((void)replay::replay(log, other, {.sample = &sample}), sim::UserError);
  };
  refused([](MachineConfig& m) { m.host.assignment = Assignment::blocks; });
  refused([](MachineConfig& m) { m.contexts = 2; });
  refused([](MachineConfig& m) { m.count.sharing = true; });
  EXPECT_THROW((void)PacketSample({}, 3, 0), sim::InternalError);
  EXPECT_THROW((void)PacketSample({1, 1}, 3, 0), sim::InternalError);
  EXPECT_THROW((void)PacketSample({3}, 3, 0), sim::InternalError);
}

}  // namespace
}  // namespace marti::processors
