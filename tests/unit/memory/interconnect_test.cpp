// Interconnects and banks to the tick: not ready at N - 1, ready at N.
#include "memory/interconnect.h"

#include <gtest/gtest.h>

#include "tests/support/memory_ports.h"

namespace marti::memory {
namespace {

using marti::test::Ports;

InterconnectConfig bus(BusMode mode) {
  InterconnectConfig config;
  config.mode = mode;
  config.clock = sim::Clock::from_period(10);
  return config;  // 8 bytes a beat, 1 cycle a beat, 1 cycle an address
}

BankConfig two_slow_banks() {
  BankConfig banks;
  banks.count = 2;
  banks.interleave = 32;
  banks.clock = sim::Clock::from_period(10);
  banks.access_cycles = 4;
  banks.busy_cycles = 6;
  return banks;
}

TEST(Bus, UnloadedReadIsAddressAccessAndBeats) {
  for (const BusMode mode : {BusMode::held, BusMode::split}) {
    Ports ports(bus(mode), two_slow_banks(), {{100, {0, 0, 32}}});
    EXPECT_EQ(ports.services[0][0].done, 100 + 10 + 40 + 40);
    EXPECT_EQ(ports.services[0][0].transfer, 50);
    EXPECT_EQ(ports.services[0][0].bank, 40);
    EXPECT_EQ(ports.interconnect->unloaded_read(32), 90);
  }
}

TEST(Bus, BytesAreRoundedUpToBeats) {
  EXPECT_EQ(Ports(bus(BusMode::held), two_slow_banks(), {{0, {0, 0, 1}}}).services[0][0].done, 60);
  EXPECT_EQ(Ports(bus(BusMode::held), two_slow_banks(), {{0, {0, 0, 8}}}).services[0][0].done, 60);
  EXPECT_EQ(Ports(bus(BusMode::held), two_slow_banks(), {{0, {0, 0, 9}}}).services[0][0].done, 70);
}

TEST(Bus, HeldReadsFollowEachOther) {
  Ports ports(bus(BusMode::held), two_slow_banks(), {{0, {0, 0, 32}}, {0, {1, 32, 32}}, {5, {2, 64, 32}}});
  EXPECT_EQ(ports.services[0][0].done, 90);
  EXPECT_EQ(ports.services[1][0].done, 180);
  EXPECT_EQ(ports.services[1][0].wait_interconnect, 90);
  EXPECT_EQ(ports.services[2][0].done, 270);
  EXPECT_EQ(ports.services[2][0].wait_interconnect, 175);
  EXPECT_EQ(ports.interconnect->statistics().busy, 270);
}

TEST(Bus, SplitReadsOverlapTheirBanks) {
  // Addresses at 0 and 10; both banks work at once; data ready at 50 and 60; data at 50..90 and 90..130.
  Ports ports(bus(BusMode::split), two_slow_banks(), {{0, {0, 0, 32}}, {0, {1, 32, 32}}});
  EXPECT_EQ(ports.services[0][0].done, 90);
  EXPECT_EQ(ports.services[1][0].done, 130);
  EXPECT_EQ(ports.services[1][0].wait_interconnect, 10 + 30);
  EXPECT_EQ(ports.services[1][0].wait_bank, 0);
  EXPECT_EQ(ports.interconnect->statistics().busy, 100);
}

// A read of the only port takes one event, with the outcome that it has beside a port that asks for nothing.
TEST(Bus, TheOnlyPortIsServedLikeOneOfTwo) {
  const std::vector<marti::test::IssuedTransaction> issues = {
      {0, {0, 0, 32}},   {200, {0, 96, 64}, true}, {200, {0, 128, 64}, true}, {205, {0, 32, 32}},
      {600, {0, 64, 8}}, {700, {0, 0, 512}, true}, {701, {0, 32, 32}}};
  Ports alone(bus(BusMode::split), two_slow_banks(), issues, 1);
  Ports beside(bus(BusMode::split), two_slow_banks(), issues, 2);
  ASSERT_EQ(alone.services[0].size(), beside.services[0].size());
  for (std::size_t i = 0; i < alone.services[0].size(); ++i) {
    EXPECT_EQ(alone.services[0][i].done, beside.services[0][i].done);
    EXPECT_EQ(alone.services[0][i].wait_interconnect, beside.services[0][i].wait_interconnect);
    EXPECT_EQ(alone.services[0][i].wait_bank, beside.services[0][i].wait_bank);
  }
  EXPECT_EQ(alone.written[0], beside.written[0]);
  EXPECT_EQ(alone.interconnect->statistics().busy, beside.interconnect->statistics().busy);
  EXPECT_EQ(alone.interconnect->statistics().waits.sum, beside.interconnect->statistics().waits.sum);
  EXPECT_EQ(alone.interconnect->statistics().waits.count, beside.interconnect->statistics().waits.count);
  EXPECT_LT(alone.engine.events(), beside.engine.events());
}

TEST(Bus, SplitReadsOfOneBankWaitForIt) {
  // The bank is busy from 10 to 70; the second access starts there and is ready at 110.
  Ports ports(bus(BusMode::split), two_slow_banks(), {{0, {0, 0, 32}}, {0, {1, 64, 32}}});
  EXPECT_EQ(ports.services[1][0].wait_bank, 70 - 20);
  EXPECT_EQ(ports.services[1][0].done, 110 + 40);
  EXPECT_EQ(ports.interconnect->bank_statistics()[0].accesses, 2);
  EXPECT_EQ(ports.interconnect->bank_statistics()[0].waits.sum, 50);
  EXPECT_EQ(ports.interconnect->bank_statistics()[1].accesses, 0);
}

TEST(Bus, PostedWriteTakesOneTenureAndItsBank) {
  Ports ports(bus(BusMode::split), two_slow_banks(), {{0, {0, 0, 4}, true}, {0, {1, 0, 32}}});
  EXPECT_EQ(ports.written[0][0], 20 + 40);
  EXPECT_EQ(ports.services[1][0].wait_interconnect, 20);
  EXPECT_EQ(ports.services[1][0].wait_bank, 80 - 30) << "the write keeps the bank from 20 to 80";
}

TEST(Crossbar, OnlyTransactionsToOneBankWait) {
  InterconnectConfig config = bus(BusMode::held);
  config.kind = InterconnectKind::crossbar;
  config.latency_cycles = 3;
  Ports ports(config, two_slow_banks(), {{0, {0, 0, 32}}, {0, {1, 32, 32}}, {0, {2, 64, 32}}});
  EXPECT_EQ(ports.services[0][0].done, 30 + 40 + 40 + 30);
  EXPECT_EQ(ports.services[1][0].done, 140);
  EXPECT_EQ(ports.services[2][0].wait_bank, 60);
  EXPECT_EQ(ports.services[2][0].done, 200);
  EXPECT_EQ(ports.interconnect->unloaded_read(32), 140);
}

TEST(Crossbar, ALongTransferHoldsTheBanksLinkNotTheBank) {
  InterconnectConfig config = bus(BusMode::held);
  config.kind = InterconnectKind::crossbar;
  config.latency_cycles = 0;
  config.width = 2;  // 16 beats: 160 ticks a line, longer than the bank's 60
  Ports ports(config, two_slow_banks(), {{0, {0, 0, 32}}, {0, {1, 0, 32}}});
  EXPECT_EQ(ports.services[0][0].done, 40 + 160);
  EXPECT_EQ(ports.services[1][0].wait_bank, 60);
  EXPECT_EQ(ports.services[1][0].wait_interconnect, 200 - 100);
  EXPECT_EQ(ports.services[1][0].done, 360);
}

TEST(Ideal, EveryTransactionTakesTheSame) {
  InterconnectConfig config = bus(BusMode::held);
  config.kind = InterconnectKind::ideal;
  config.latency_cycles = 7;
  Ports ports(config, two_slow_banks(), {{0, {0, 0, 32}}, {0, {1, 0, 4000}}, {3, {2, 0, 1}, true}});
  EXPECT_EQ(ports.services[0][0].done, 70);
  EXPECT_EQ(ports.services[1][0].done, 70);
  EXPECT_EQ(ports.written[2][0], 73);
}

}  // namespace
}  // namespace marti::memory
