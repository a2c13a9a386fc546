// DRAM behind the interconnects: against the channels alone, which get the same accesses without events, and
// against banks of fixed access time where DRAM takes as long.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "memory/cache.h"
#include "memory/dram_presets.h"
#include "memory/interconnect.h"
#include "tests/support/memory_ports.h"
#include "tests/unit/memory/dram_streams.h"

namespace marti::memory {
namespace {

using marti::test::IssuedTransaction;
using marti::test::Ports;

constexpr std::uint32_t line = 64;

BankConfig dram_of(DramPolicy policy, std::uint32_t channels) {
  BankConfig banks;
  banks.interleave = line;
  banks.dram = dram_preset(0);
  banks.dram->policy = policy;
  banks.dram->channels = channels;
  return banks;
}

// A crossbar whose data take no time, so that a read ends `latency` after its data are ready.
InterconnectConfig crossbar(std::int64_t latency) {
  InterconnectConfig config;
  config.kind = InterconnectKind::crossbar;
  config.clock = sim::Clock::from_period(700);
  config.cycles_per_beat = 0;
  config.latency_cycles = latency;
  return config;
}

// Every port issues one read or write, in bursts and with pauses. No two have one address.
std::vector<IssuedTransaction> random_issues(std::mt19937_64& random, std::uint32_t count) {
  std::vector<IssuedTransaction> issues;
  sim::Ticks now = 0;
  const std::uint64_t rows = 1 + random() % 64;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Address address = ((random() % rows) * 131072 + i % 2048 * 64) * 16 % (Address{1} << 33U);
    issues.push_back({now, {i, address, line}, random() % 4 == 0});
    now += random() % 3 == 0 ? 0 : static_cast<sim::Ticks>(random() % (random() % 8 == 0 ? 200000 : 9000));
  }
  return issues;
}

// What the channels of this memory make of the same accesses.
std::vector<DramService> alone(const DramConfig& config, const std::vector<IssuedTransaction>& issues,
                               sim::Ticks latency) {
  const DramMapping mapping(config);
  std::vector<memory::test::StreamAccess> accesses;
  for (const IssuedTransaction& issue : issues) {
    const Address address = issue.transaction.address;
    accesses.push_back({(issue.at + latency + config.period - 1) / config.period, address,
                        mapping.place(address), issue.write});
  }
  return memory::test::run_stream(config, accesses).services;
}

TEST(DramInterconnect, EventsFindWhatTheChannelsAloneDo) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    std::mt19937_64 random(seed);
    const DramPolicy policy = seed % 2 == 0 ? DramPolicy::fcfs : DramPolicy::frfcfs;
    BankConfig banks = dram_of(policy, 1U << random() % 3);
    banks.dram->page = random() % 2 == 0 ? DramPage::open : DramPage::closed;
    const InterconnectConfig config = crossbar(static_cast<std::int64_t>(random() % 40));
    const std::vector<IssuedTransaction> issues = random_issues(random, 300);
    const sim::Ticks latency = config.clock.cycles(config.latency_cycles);
    const std::vector<DramService> expected = alone(*banks.dram, issues, latency);
    const Ports ports(config, banks, issues, 300);
    std::int64_t bytes = 0;
    for (std::uint32_t i = 0; i < issues.size(); ++i) {
      const sim::Ticks ready = expected[i].end * banks.dram->period;
      if (issues[i].write) {
        ASSERT_EQ(ports.written[i], std::vector<sim::Ticks>{ready}) << "seed " << seed << ", access " << i;
        continue;
      }
      ASSERT_EQ(ports.services[i].size(), 1U);
      const Service& service = ports.services[i].front();
      const sim::Ticks start = (expected[i].first - 1) * banks.dram->period;
      ASSERT_EQ(service.done, ready + latency) << "seed " << seed << ", access " << i;
      ASSERT_EQ(service.bank, ready - start);
      ASSERT_EQ(service.wait_bank, start - issues[i].at - latency);
      ASSERT_EQ(service.done - issues[i].at,
                service.wait_bank + service.bank + service.transfer + service.wait_interconnect);
    }
    for (const DramStatistics& channel : ports.interconnect->dram_statistics(0)) {
      bytes += channel.bytes;
    }
    EXPECT_EQ(bytes, 300 * std::int64_t{line});
  }
}

// A second level before channels that change the order: which reads hit is decided in the order of arrival,
// the channels get the misses and the writes, and a hit waits for its line.
TEST(DramInterconnect, HitsOfASharedCacheWaitForLinesThatAQueueBrings) {
  std::int64_t waited = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    std::mt19937_64 random(seed);
    BankConfig banks = dram_of(DramPolicy::frfcfs, 1U << random() % 3);
    banks.cache = SharedCacheConfig{
        {.size = line << random() % 6, .line = line, .ways = 1}, sim::Clock::from_period(1100), 3};
    const sim::Ticks hit_ticks = 3300;
    const InterconnectConfig config = crossbar(static_cast<std::int64_t>(random() % 40));
    const sim::Ticks latency = config.clock.cycles(config.latency_cycles);
    std::vector<IssuedTransaction> issues = random_issues(random, 300);
    for (IssuedTransaction& issue : issues) {
      // Few lines, so that some are missed again while they are on their way. Writes are to other addresses.
      issue.transaction.address = (issue.write ? 1U << 30U : 0U) + random() % 48 * line * 33;
    }
    Cache tags(banks.cache->cache);
    std::vector<IssuedTransaction> below;
    std::vector<std::size_t> brought_by(issues.size());  // place in `below` of the access that has the data
    std::vector<bool> hits(issues.size());
    std::map<Address, std::size_t> last_miss;
    for (std::size_t i = 0; i < issues.size(); ++i) {
      const Address address = issues[i].transaction.address;
      hits[i] = !issues[i].write && tags.read(address, 1) == 0;
      if (!hits[i]) {
        last_miss[address] = below.size();
        below.push_back(issues[i]);
      }
      brought_by[i] = last_miss.at(address);
    }
    const std::vector<DramService> served = alone(*banks.dram, below, latency);
    const Ports ports(config, banks, issues, 300);
    for (std::size_t i = 0; i < issues.size(); ++i) {
      const sim::Ticks there = served[brought_by[i]].end * banks.dram->period;
      const sim::Ticks arrival = issues[i].at + latency;
      const sim::Ticks ready = hits[i] ? std::max(arrival + hit_ticks, there) : there;
      waited += hits[i] && there > arrival + hit_ticks ? 1 : 0;
      if (issues[i].write) {
        ASSERT_EQ(ports.written[i], std::vector<sim::Ticks>{ready}) << "seed " << seed << ", access " << i;
        continue;
      }
      ASSERT_EQ(ports.services[i].size(), 1U) << "seed " << seed << ", access " << i;
      const Service& service = ports.services[i].front();
      ASSERT_EQ(service.done, ready + latency) << "seed " << seed << ", access " << i;
      ASSERT_EQ(service.done - issues[i].at,
                service.wait_bank + service.bank + service.transfer + service.wait_interconnect);
    }
    const SharedCacheStatistics& cache = *ports.interconnect->cache_statistics();
    EXPECT_EQ(cache.lookups.hits, std::count(hits.begin(), hits.end(), true));
  }
  EXPECT_GT(waited, 500);
}

// On a bus that sends one address at a time, commands are decided before the next address can come. What the
// channels do is what they do alone with the arrivals that the bus gives them.
TEST(DramInterconnect, ABusDecidesEarlyWhatTheChannelsAloneDo) {
  for (std::uint64_t seed = 300; seed < 360; ++seed) {
    std::mt19937_64 random(seed);
    BankConfig banks = dram_of(DramPolicy::frfcfs, 1U << random() % 3);
    banks.dram->page = random() % 2 == 0 ? DramPage::open : DramPage::closed;
    InterconnectConfig config = crossbar(0);
    config.kind = InterconnectKind::bus;
    config.address_cycles = static_cast<std::int64_t>(random() % 60);
    const std::vector<IssuedTransaction> issues = random_issues(random, 300);
    const sim::Ticks address = config.clock.cycles(config.address_cycles);
    std::vector<IssuedTransaction> sent = issues;  // when the bus takes each
    sim::Ticks free = 0;
    for (IssuedTransaction& issue : sent) {
      issue.at = std::max(issue.at, free);
      free = issue.at + address;
    }
    const std::vector<DramService> expected = alone(*banks.dram, sent, address);
    const Ports ports(config, banks, issues, 300);
    for (std::uint32_t i = 0; i < issues.size(); ++i) {
      const sim::Ticks ready = expected[i].end * banks.dram->period;
      if (issues[i].write) {
        ASSERT_EQ(ports.written[i], std::vector<sim::Ticks>{ready}) << "seed " << seed << ", access " << i;
        continue;
      }
      const Service& service = ports.services[i].front();
      const sim::Ticks start = (expected[i].first - 1) * banks.dram->period;
      ASSERT_EQ(service.bank, ready - start) << "seed " << seed << ", access " << i;
      ASSERT_EQ(service.wait_bank, start - sent[i].at - address) << "seed " << seed << ", access " << i;
    }
  }
}

// An open row that is never left, whose commands need no time between each other, is a bank that takes as
// long for every access and can begin one in each cycle.
TEST(DramInterconnect, AMemoryOfOneRowIsABankOfFixedTime) {
  constexpr sim::Ticks period = 1000;
  for (const DramPolicy policy : {DramPolicy::fcfs, DramPolicy::frfcfs}) {
    for (const Arbitration arbitration :
         {Arbitration::fifo, Arbitration::round_robin, Arbitration::fixed_priority}) {
      BankConfig dram = dram_of(policy, 1);
      dram.dram->period = period;
      dram.dram->timing = {.bl = 1,
                           .cl = 5,
                           .cwl = 5,
                           .rcd = 1,
                           .rcd_write = 1,
                           .rp = 1,
                           .ras = 1,
                           .rc = 2,
                           .rrd_s = 1,
                           .rrd_l = 1,
                           .faw = 1,
                           .ccd_s = 1,
                           .ccd_l = 1,
                           .ccd_l_write = 1,
                           .wr = 1,
                           .wtr_s = 1,
                           .wtr_l = 1,
                           .rtp = 1,
                           .rtw_gap = 0,
                           .rank_gap = 0,
                           .refi = 0,
                           .rfc = 1};
      BankConfig fixed;
      fixed.count = 1;
      fixed.interleave = line;
      fixed.clock = sim::Clock::from_period(period);
      fixed.access_cycles = 7;  // the controller's cycle, cl and bl
      fixed.busy_cycles = 1;
      InterconnectConfig config;
      config.clock = sim::Clock::from_period(period);
      config.arbitration = arbitration;
      std::mt19937_64 random(7);
      std::vector<IssuedTransaction> issues = {{0, {0, 0, line}, false}};
      for (std::uint32_t i = 1; i < 200; ++i) {
        issues.push_back({100 * period + static_cast<sim::Ticks>(random() % 4000) * period,
                          {i, random() % 128 * line, line},
                          false});
      }
      const Ports with_dram(config, dram, issues, 200);
      const Ports with_banks(config, fixed, issues, 200);
      for (std::uint32_t port = 1; port < 200; ++port) {
        ASSERT_EQ(with_dram.services[port].front().done, with_banks.services[port].front().done) << port;
      }
      EXPECT_EQ(with_dram.interconnect->unloaded_read(line), 9 * period + 8 * period);
    }
  }
}

// What a single port asks for is decided at once; beside ports that ask for nothing it is decided by events.
TEST(DramInterconnect, ASinglePortIsServedAsOneOfManyThatAreSilent) {
  for (std::uint64_t seed = 200; seed < 260; ++seed) {
    std::mt19937_64 random(seed);
    BankConfig banks = dram_of(DramPolicy::frfcfs, 1U << random() % 2);
    banks.dram->page = random() % 2 == 0 ? DramPage::open : DramPage::closed;
    InterconnectConfig config = crossbar(static_cast<std::int64_t>(random() % 20));
    config.kind = seed % 3 == 0 ? InterconnectKind::crossbar : InterconnectKind::bus;
    config.arbitration = seed % 3 == 1 ? Arbitration::fifo : Arbitration::round_robin;
    config.cycles_per_beat = 1;
    std::vector<IssuedTransaction> issues;
    sim::Ticks now = 0;
    for (std::uint32_t i = 0; i < 300; ++i) {
      const bool write = random() % 2 == 0;
      issues.push_back({now, {0, random() % 65536 * line, line}, write});
      // A read is done before anything else is asked for.
      now += write ? static_cast<sim::Ticks>(random() % 90000)
                   : 3000000 + static_cast<sim::Ticks>(random() % 90000);
    }
    const Ports alone(config, banks, issues, 1);
    const Ports beside(config, banks, issues, 2);
    EXPECT_EQ(alone.written[0], beside.written[0]) << seed;
    ASSERT_EQ(alone.services[0].size(), beside.services[0].size());
    for (std::size_t i = 0; i < alone.services[0].size(); ++i) {
      EXPECT_EQ(alone.services[0][i].done, beside.services[0][i].done) << seed << ", read " << i;
      EXPECT_EQ(alone.services[0][i].wait_bank, beside.services[0][i].wait_bank);
    }
    EXPECT_LT(alone.engine.events(), beside.engine.events());
  }
}

TEST(DramInterconnect, WritesAreReportedInTheOrderOfEachPort) {
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    std::mt19937_64 random(seed);
    const BankConfig banks = dram_of(DramPolicy::frfcfs, 2);
    InterconnectConfig config;
    config.clock = sim::Clock::from_period(500);
    config.arbitration = static_cast<Arbitration>(seed % 3);
    std::vector<IssuedTransaction> issues;
    std::map<std::uint32_t, std::size_t> writes;
    for (std::uint32_t i = 0; i < 400; ++i) {
      const bool write = i % 8 != 0;
      // Writes of four ports, and reads, of which each has a port of its own.
      const std::uint32_t port = write ? i % 4 : 4 + i / 8;
      issues.push_back(
          {static_cast<sim::Ticks>(random() % 3000000), {port, random() % 4096 * line, line}, write});
      writes[port] += write ? 1 : 0;
    }
    const Ports ports(config, banks, issues, 64);
    for (const auto& [port, count] : writes) {
      EXPECT_EQ(ports.written[port].size(), count);
      EXPECT_EQ(ports.services[port].size(), port < 4 ? 0U : 1U);
    }
    std::int64_t accesses = 0;
    for (const BankStatistics& channel : ports.interconnect->bank_statistics()) {
      accesses += channel.accesses;
    }
    EXPECT_EQ(accesses, 400);
  }
}

}  // namespace
}  // namespace marti::memory
