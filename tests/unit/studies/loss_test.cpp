// The parts of the lost speed-up add up, and each has its cause.
#include "studies/figures/loss.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/random_machine.h"

namespace marti::studies {
namespace {

using processors::MachineConfig;
using processors::MachineResult;

struct Pair {
  MachineResult one;
  MachineResult all;
};

Pair time_both(const processors::WorkLog& log, MachineConfig machine) {
  Pair pair;
  pair.all = processors::replay(log, machine);
  machine.clusters = 1;
  machine.nodes = 1;
  pair.one = processors::replay(log, machine);
  return pair;
}

sim::Ticks part(const SpeedUpLoss& loss, Loss which) { return loss.parts[static_cast<std::size_t>(which)]; }

RC_GTEST_PROP(SpeedUpLosses, AddUpForEveryMachine, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_tree_log(random, 9, 7);
  MachineConfig machine = test::random_machine(random);
  // A bus that is not granted first come first served has no tree that is built and shared.
  if (machine.placement == processors::Placement::shared &&
      machine.interconnect.arbitration == memory::Arbitration::fifo && random() % 2 == 0) {
    machine.build = test::random_build(random);
  }
  const Pair pair = time_both(log, machine);
  const SpeedUpLoss loss = loss_of(pair.one, pair.all);
  sim::Ticks sum = 0;
  for (const sim::Ticks p : loss.parts) {
    sum += p;
  }
  RC_ASSERT(sum == loss.total);
  RC_ASSERT(loss.total == pair.all.end * static_cast<sim::Ticks>(pair.all.nodes.size()) - pair.one.end);
  RC_ASSERT(part(loss, Loss::idle) >= 0);
}

TEST(SpeedUpLosses, OneNodeLosesNothing) {
  test::Random random(3);
  const processors::WorkLog log = test::random_log(random, 6, 6);
  MachineConfig machine = test::random_machine(random);
  machine.clusters = 1;
  machine.nodes = 1;
  const MachineResult one = processors::replay(log, machine);
  for (const sim::Ticks p : loss_of(one, one).parts) {
    EXPECT_EQ(p, 0);
  }
}

// A machine with only one cause of loss has only that part.
TEST(SpeedUpLosses, EachPartIsWhatItSays) {
  test::Random random(4);
  const processors::WorkLog log = test::random_log(random, 16, 16);
  MachineConfig machine = test::random_machine(random);
  machine.clusters = 1;
  machine.nodes = 8;
  machine.placement = processors::Placement::shared;
  machine.cache.organisation = processors::CacheOrganisation::none;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.latency_cycles = 7;
  machine.operations = {1, 2, 3, 4, 1, 1, 1, 1};
  machine.write_buffer = 4096;
  machine.host = {processors::Assignment::interleaved, sim::Clock::from_period(10), 0, 0};
  machine.packets = {1, 1, processors::PacketOrder::scanline};
  SpeedUpLoss loss = loss_of(time_both(log, machine).one, time_both(log, machine).all);
  EXPECT_EQ(part(loss, Loss::extra_misses), 0) << "without caches nobody misses more";
  EXPECT_EQ(part(loss, Loss::contention), 0) << "nothing is shared";
  EXPECT_EQ(part(loss, Loss::overhead), 0);
  EXPECT_EQ(part(loss, Loss::idle), 0);
  EXPECT_GT(part(loss, Loss::imbalance), 0);
  EXPECT_EQ(part(loss, Loss::imbalance), loss.total);

  machine.interconnect.kind = memory::InterconnectKind::bus;
  EXPECT_GT(part(loss_of(time_both(log, machine).one, time_both(log, machine).all), Loss::contention), 0);

  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.cache.organisation = processors::CacheOrganisation::unified;
  machine.cache.cache = {.size = 1U << 20U, .line = 64, .ways = 0};
  loss = loss_of(time_both(log, machine).one, time_both(log, machine).all);
  EXPECT_GT(part(loss, Loss::extra_misses), 0) << "every cache is filled anew";
  EXPECT_EQ(part(loss, Loss::contention), 0);

  machine.packets = {16, 16, processors::PacketOrder::scanline};
  const Pair pair = time_both(log, machine);
  loss = loss_of(pair.one, pair.all);
  EXPECT_EQ(part(loss, Loss::idle), loss.total) << "one packet, so seven nodes never have work";
  EXPECT_EQ(loss.total, 7 * pair.all.end);
}

}  // namespace
}  // namespace marti::studies
