// Interconnects and banks to the tick: not ready at N - 1, ready at N.
#include "memory/interconnect.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace marti::memory {
namespace {

constexpr std::uint8_t issue_class = 3;
constexpr std::uint8_t reply_class = 2;

// Ports that issue given reads at given times and remember when they were served.
class Ports final : public InterconnectClient, public sim::EventHandler {
 public:
  struct Read {
    sim::Ticks at;
    Transaction transaction;
    bool write = false;
  };

  Ports(const InterconnectConfig& config, const BankConfig& banks, std::vector<Read> reads)
      : reads_(std::move(reads)), services(reads_.size()), written(reads_.size()) {
    interconnect = make_interconnect(config, banks, {engine, *this, reply_class, 0, 64});
    engine.attach(issue_class, *this);
    engine.attach(reply_class, *this);
    for (std::uint32_t i = 0; i < reads_.size(); ++i) {
      engine.post(sim::Event::make(reads_[i].at, issue_class, i));
    }
    engine.run(1000);
  }
  void handle(const sim::Event& event) override {
    if (event.event_class() == reply_class) {
      interconnect->reply(event.component());
      return;
    }
    const Read& read = reads_[event.component()];
    read.write ? interconnect->write(read.transaction) : interconnect->read(read.transaction);
  }
  void read_done(std::uint32_t port, const Service& service) override { services[port] = service; }
  void write_done(std::uint32_t port, sim::Ticks done) override { written[port] = done; }

 private:
  std::vector<Read> reads_;

 public:
  sim::Engine engine;
  std::unique_ptr<Interconnect> interconnect;
  std::vector<Service> services;
  std::vector<sim::Ticks> written;
};

InterconnectConfig bus(BusMode mode) {
  InterconnectConfig config;
  config.mode = mode;
  config.clock = sim::Clock::from_period(10);
  return config;  // 8 bytes a beat, 1 cycle a beat, 1 cycle an address
}

BankConfig two_banks() {
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
    Ports ports(bus(mode), two_banks(), {{100, {0, 0, 32}}});
    EXPECT_EQ(ports.services[0].done, 100 + 10 + 40 + 40);
    EXPECT_EQ(ports.services[0].transfer, 50);
    EXPECT_EQ(ports.services[0].bank, 40);
    EXPECT_EQ(ports.interconnect->unloaded_read(32), 90);
  }
}

TEST(Bus, BytesAreRoundedUpToBeats) {
  EXPECT_EQ(Ports(bus(BusMode::held), two_banks(), {{0, {0, 0, 1}}}).services[0].done, 60);
  EXPECT_EQ(Ports(bus(BusMode::held), two_banks(), {{0, {0, 0, 8}}}).services[0].done, 60);
  EXPECT_EQ(Ports(bus(BusMode::held), two_banks(), {{0, {0, 0, 9}}}).services[0].done, 70);
}

TEST(Bus, HeldReadsFollowEachOther) {
  Ports ports(bus(BusMode::held), two_banks(), {{0, {0, 0, 32}}, {0, {1, 32, 32}}, {5, {2, 64, 32}}});
  EXPECT_EQ(ports.services[0].done, 90);
  EXPECT_EQ(ports.services[1].done, 180);
  EXPECT_EQ(ports.services[1].wait_interconnect, 90);
  EXPECT_EQ(ports.services[2].done, 270);
  EXPECT_EQ(ports.services[2].wait_interconnect, 175);
  EXPECT_EQ(ports.interconnect->statistics().busy, 270);
}

TEST(Bus, SplitReadsOverlapTheirBanks) {
  // Addresses at 0 and 10; both banks work at once; data ready at 50 and 60; data at 50..90 and 90..130.
  Ports ports(bus(BusMode::split), two_banks(), {{0, {0, 0, 32}}, {0, {1, 32, 32}}});
  EXPECT_EQ(ports.services[0].done, 90);
  EXPECT_EQ(ports.services[1].done, 130);
  EXPECT_EQ(ports.services[1].wait_interconnect, 10 + 30);
  EXPECT_EQ(ports.services[1].wait_bank, 0);
  EXPECT_EQ(ports.interconnect->statistics().busy, 100);
}

TEST(Bus, SplitReadsOfOneBankWaitForIt) {
  // The bank is busy from 10 to 70; the second access starts there and is ready at 110.
  Ports ports(bus(BusMode::split), two_banks(), {{0, {0, 0, 32}}, {0, {1, 64, 32}}});
  EXPECT_EQ(ports.services[1].wait_bank, 70 - 20);
  EXPECT_EQ(ports.services[1].done, 110 + 40);
  EXPECT_EQ(ports.interconnect->bank_statistics()[0].accesses, 2);
  EXPECT_EQ(ports.interconnect->bank_statistics()[0].waits.sum, 50);
  EXPECT_EQ(ports.interconnect->bank_statistics()[1].accesses, 0);
}

TEST(Bus, PostedWriteTakesOneTenureAndItsBank) {
  Ports ports(bus(BusMode::split), two_banks(), {{0, {0, 0, 4}, true}, {0, {1, 0, 32}}});
  EXPECT_EQ(ports.written[0], 20 + 40);
  EXPECT_EQ(ports.services[1].wait_interconnect, 20);
  EXPECT_EQ(ports.services[1].wait_bank, 80 - 30) << "the write keeps the bank from 20 to 80";
}

TEST(Crossbar, OnlyTransactionsToOneBankWait) {
  InterconnectConfig config = bus(BusMode::held);
  config.kind = InterconnectKind::crossbar;
  config.latency_cycles = 3;
  Ports ports(config, two_banks(), {{0, {0, 0, 32}}, {0, {1, 32, 32}}, {0, {2, 64, 32}}});
  EXPECT_EQ(ports.services[0].done, 30 + 40 + 40 + 30);
  EXPECT_EQ(ports.services[1].done, 140);
  EXPECT_EQ(ports.services[2].wait_bank, 60);
  EXPECT_EQ(ports.services[2].done, 200);
  EXPECT_EQ(ports.interconnect->unloaded_read(32), 140);
}

TEST(Crossbar, ALongTransferHoldsTheBanksLinkNotTheBank) {
  InterconnectConfig config = bus(BusMode::held);
  config.kind = InterconnectKind::crossbar;
  config.latency_cycles = 0;
  config.width = 2;  // 16 beats: 160 ticks a line, longer than the bank's 60
  Ports ports(config, two_banks(), {{0, {0, 0, 32}}, {0, {1, 0, 32}}});
  EXPECT_EQ(ports.services[0].done, 40 + 160);
  EXPECT_EQ(ports.services[1].wait_bank, 60);
  EXPECT_EQ(ports.services[1].wait_interconnect, 200 - 100);
  EXPECT_EQ(ports.services[1].done, 360);
}

TEST(Ideal, EveryTransactionTakesTheSame) {
  InterconnectConfig config = bus(BusMode::held);
  config.kind = InterconnectKind::ideal;
  config.latency_cycles = 7;
  Ports ports(config, two_banks(), {{0, {0, 0, 32}}, {0, {1, 0, 4000}}, {3, {2, 0, 1}, true}});
  EXPECT_EQ(ports.services[0].done, 70);
  EXPECT_EQ(ports.services[1].done, 70);
  EXPECT_EQ(ports.written[2], 73);
}

// Deterministic closed network D/D/1//N: N ports think for Z and then hold the bus for S. After the first
// round the throughput is min(N / (Z + S), 1 / S), with no variance.
class ClosedNetwork final : public InterconnectClient, public sim::EventHandler {
 public:
  ClosedNetwork(std::uint32_t ports, sim::Ticks think, std::int64_t rounds)
      : think_(think), left_(ports, rounds) {
    InterconnectConfig config = bus(BusMode::held);
    interconnect_ = make_interconnect(config, two_banks(), {engine_, *this, reply_class, 0, ports});
    service = interconnect_->unloaded_read(32);
    engine_.attach(issue_class, *this);
    for (std::uint32_t port = 0; port < ports; ++port) {
      engine_.post(sim::Event::make(think_, issue_class, port));
    }
    engine_.run(1'000'000);
  }
  void handle(const sim::Event& event) override {
    // Alternate banks, so that the banks' busy time stays hidden behind the held bus.
    interconnect_->read({event.component(), 32 * (served & 1), 32});
  }
  void read_done(std::uint32_t port, const Service& done) override {
    ++served;
    end = done.done;
    if (--left_[port] > 0) {
      engine_.post(sim::Event::make(done.done + think_, issue_class, port));
    }
  }
  void write_done(std::uint32_t, sim::Ticks) override {}

  sim::Ticks service = 0;
  sim::Ticks end = 0;
  std::uint64_t served = 0;

 private:
  sim::Ticks think_;
  sim::Engine engine_;
  std::unique_ptr<Interconnect> interconnect_;
  std::vector<std::int64_t> left_;
};

TEST(Bus, ClosedDeterministicNetworkHasItsExactThroughput) {
  constexpr std::int64_t rounds = 200;
  for (const std::uint32_t n : {1U, 2U, 3U, 7U, 11U, 12U, 40U}) {
    ClosedNetwork network(n, 900, rounds);
    ASSERT_EQ(network.service, 90);
    // All ports start together. While n * S <= Z + S a port never waits after the first round; beyond
    // that the bus never rests after the first think time.
    const sim::Ticks first = 900;
    const sim::Ticks expected = n * 90 <= 990 ? first + n * 90 + (rounds - 1) * 990
                                              : first + static_cast<sim::Ticks>(n) * rounds * 90;
    EXPECT_EQ(network.end, expected) << n << " ports";
  }
}

}  // namespace
}  // namespace marti::memory
