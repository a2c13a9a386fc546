// The bus that is granted by round robin or fixed priority: against a list of all that wait, against the bus
// that serves first come first served, and against laws that hold for every arbitration.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "memory/interconnect.h"
#include "memory/port_set.h"
#include "tests/support/memory_ports.h"

namespace marti::memory {
namespace {

using test::Ports;
using Issue = test::IssuedTransaction;

// 8 bytes a beat of 10, 10 an address, two banks of 40 to the data and 60 to the next access.
InterconnectConfig bus(Arbitration arbitration, BusMode mode) {
  InterconnectConfig config;
  config.arbitration = arbitration;
  config.mode = mode;
  config.clock = sim::Clock::from_period(10);
  return config;
}

BankConfig two_banks() {
  BankConfig banks;
  banks.count = 2;
  banks.clock = sim::Clock::from_period(10);
  return banks;
}

constexpr std::array arbitrated = {Arbitration::round_robin, Arbitration::fixed_priority};

TEST(Arbitration, NoReadOfAPortOvertakesItsWrites) {
  for (const Arbitration arbitration : arbitrated) {
    Ports ports(bus(arbitration, BusMode::held), two_banks(),
                {{0, {0, 0, 8}, true}, {0, {0, 32, 8}, true}, {1, {0, 64, 32}}, {2, {1, 96, 8}, true}});
    EXPECT_EQ(ports.written[0].size(), 2U);
    EXPECT_GT(ports.services[0][0].wait_interconnect, 0);
    EXPECT_EQ(ports.services[0][0].done - ports.services[0][0].transfer - ports.services[0][0].bank -
                  ports.services[0][0].wait_bank - ports.services[0][0].wait_interconnect,
              1);
    EXPECT_GE(ports.services[0][0].wait_interconnect, 2 * 20 - 1) << "both writes of 20 come first";
  }
}

struct Traffic {
  std::vector<Issue> issues;
  InterconnectConfig config;
  BankConfig banks;
};

Traffic random_traffic(std::uint64_t seed, bool writes_only) {
  std::mt19937_64 random(seed);
  const auto pick = [&](std::int64_t lo, std::int64_t hi) {
    return lo + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(hi - lo + 1));
  };
  Traffic traffic;
  traffic.config.clock = sim::Clock::from_period(pick(1, 20));
  traffic.config.mode = static_cast<BusMode>(pick(0, 1));
  traffic.config.width = static_cast<std::uint32_t>(pick(1, 16));
  traffic.config.cycles_per_beat = pick(0, 2);
  traffic.config.address_cycles = pick(0, 2);
  traffic.banks.count = static_cast<std::uint32_t>(pick(1, 4));
  traffic.banks.clock = sim::Clock::from_period(pick(1, 20));
  traffic.banks.access_cycles = pick(0, 6);
  traffic.banks.busy_cycles = pick(0, 9);
  sim::Ticks now = 0;
  for (std::uint32_t i = 0; i < 60; ++i) {
    now += pick(0, 3) == 0 ? pick(0, 400) : 0;
    // Each port reads once at most; ports 0 to 3 write.
    const bool write = writes_only || pick(0, 1) == 0;
    const auto port = static_cast<std::uint32_t>(write ? pick(0, 3) : i + 4);
    traffic.issues.push_back(
        {now, {port, static_cast<Address>(pick(0, 2000)), static_cast<std::uint32_t>(pick(1, 64))}, write});
  }
  return traffic;
}

RC_GTEST_PROP(Arbitration, EqualsFirstComeFirstServedWhenNeverTwoWait, (std::uint64_t seed)) {
  Traffic traffic = random_traffic(seed, false);
  for (std::size_t i = 0; i < traffic.issues.size(); ++i) {
    traffic.issues[i].at = static_cast<sim::Ticks>(i) * 100'000;
  }
  const Ports fifo(traffic.config, traffic.banks, traffic.issues);
  for (const Arbitration arbitration : arbitrated) {
    traffic.config.arbitration = arbitration;
    const Ports other(traffic.config, traffic.banks, traffic.issues);
    RC_ASSERT(other.written == fifo.written);
    RC_ASSERT(other.end == fifo.end);
    for (std::size_t port = 0; port < fifo.services.size(); ++port) {
      RC_ASSERT(other.services[port].size() == fifo.services[port].size());
      for (std::size_t i = 0; i < fifo.services[port].size(); ++i) {
        RC_ASSERT(other.services[port][i].done == fifo.services[port][i].done);
        RC_ASSERT(other.services[port][i].transfer == fifo.services[port][i].transfer);
        RC_ASSERT(other.services[port][i].wait_interconnect == 0);
      }
    }
    RC_ASSERT(other.interconnect->statistics().busy == fifo.interconnect->statistics().busy);
    RC_ASSERT(other.interconnect->statistics().waits.count == fifo.interconnect->statistics().waits.count);
  }
}

RC_GTEST_PROP(Arbitration, KeepsTheBusAsBusyInAnyOrder, (std::uint64_t seed)) {
  // Writes hold the bus for a time that does not depend on their order: a bus that never rests while a
  // request waits is then busy in the same intervals, whichever request it serves.
  for (const bool writes_only : {true, false}) {
    Traffic traffic = random_traffic(seed, writes_only);
    if (writes_only) {
      traffic.banks.access_cycles = 0;  // a write is done when the bus is, so the end is the bus's
      traffic.banks.busy_cycles = 0;
    } else {
      traffic.config.mode = BusMode::split;
    }
    const Ports fifo(traffic.config, traffic.banks, traffic.issues);
    const InterconnectStatistics& expected = fifo.interconnect->statistics();
    for (const Arbitration arbitration : arbitrated) {
      traffic.config.arbitration = arbitration;
      const Ports other(traffic.config, traffic.banks, traffic.issues);
      const InterconnectStatistics& got = other.interconnect->statistics();
      RC_ASSERT(got.reads == expected.reads);
      RC_ASSERT(got.writes == expected.writes);
      RC_ASSERT(got.bytes == expected.bytes);
      RC_ASSERT(got.busy == expected.busy);
      RC_ASSERT(got.waits.count == expected.waits.count);
      RC_ASSERT(!writes_only || other.end == fifo.end);
      std::int64_t accesses = 0;
      for (const BankStatistics& bank : other.interconnect->bank_statistics()) {
        accesses += bank.accesses;
      }
      RC_ASSERT(accesses == got.reads + got.writes);
      sim::Ticks waited = 0;
      for (const auto& port : other.services) {
        for (const Service& service : port) {
          waited += service.wait_interconnect;
        }
      }
      RC_ASSERT(waited <= got.waits.sum);
      if (writes_only && traffic.config.cycles_per_beat == 0) {
        // All tenures are of one length, so the sum of all waits does not depend on the order either.
        RC_ASSERT(got.waits.sum == expected.waits.sum);
      }
    }
  }
}

// The requests that wait for the bus, in one long list.
struct Waiting {
  sim::Ticks at = 0;
  Transaction transaction;
  bool write = false;
  bool data = false;
  sim::Ticks waited = 0;  // data: what its address waited for the bus, and for the bank
  sim::Ticks bank_wait = 0;
};

// The grants worked out once more: whenever the bus is free, look through the list of all that wait.
RC_GTEST_PROP(Arbitration, GrantsAreThoseThatALongListSays, (std::uint64_t seed)) {
  Traffic traffic = random_traffic(seed, false);
  const sim::Clock& clock = traffic.config.clock;
  const sim::Ticks address = clock.cycles(traffic.config.address_cycles);
  const sim::Ticks access = traffic.banks.clock.cycles(traffic.banks.access_cycles);
  for (const Arbitration arbitration : arbitrated) {
    traffic.config.arbitration = arbitration;
    const Ports ports(traffic.config, traffic.banks, traffic.issues);
    std::vector<Waiting> waiting;
    for (const Issue& issue : traffic.issues) {
      waiting.push_back({issue.at, issue.transaction, issue.write});
    }
    std::vector<sim::Ticks> bank_free(traffic.banks.count);
    std::vector<std::vector<sim::Ticks>> written(64);
    sim::Ticks free = 0;
    sim::Ticks busy = 0;
    std::uint32_t last = 63;
    while (!waiting.empty()) {
      sim::Ticks now = waiting[0].at;
      for (const Waiting& one : waiting) {
        now = std::min(now, one.at);
      }
      now = std::max(now, free);
      // By priority, and among equals the first of the list, which is in the order of asking.
      std::size_t best = waiting.size();
      std::tuple<bool, std::uint32_t, bool> best_rank;
      for (std::size_t i = 0; i < waiting.size(); ++i) {
        const std::uint32_t port = waiting[i].transaction.port;
        const bool data = waiting[i].data;
        const std::tuple<bool, std::uint32_t, bool> rank =
            arbitration == Arbitration::fixed_priority
                ? std::tuple(!data, port, false)
                : std::tuple(false, (port + 64 - (last + 1) % 64) % 64, !data);
        if (waiting[i].at <= now && (best == waiting.size() || rank < best_rank)) {
          best = i;
          best_rank = rank;
        }
      }
      const Waiting granted = waiting[best];
      waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(best));
      const auto& [port, at, bytes] = granted.transaction;
      last = port;
      const std::int64_t width = traffic.config.width;
      const sim::Ticks beats = clock.cycles((bytes + width - 1) / width * traffic.config.cycles_per_beat);
      if (granted.data) {
        free = now + beats;
        busy += beats;
        const Service& got = ports.services[port].at(0);
        RC_ASSERT(got.done == free);
        RC_ASSERT(got.wait_interconnect == granted.waited + now - granted.at);
        RC_ASSERT(got.wait_bank == granted.bank_wait);
        continue;
      }
      const sim::Ticks sent = now + address + (granted.write ? beats : 0);
      sim::Ticks& bank = bank_free[at / traffic.banks.interleave % traffic.banks.count];
      const sim::Ticks start = std::max(sent, bank);
      bank = start + traffic.banks.clock.cycles(traffic.banks.busy_cycles);
      free = sent;
      if (granted.write) {
        written[port].push_back(start + access);
      } else if (traffic.config.mode == BusMode::split) {
        waiting.push_back({start + access, granted.transaction, false, true, now - granted.at, start - sent});
      } else {
        free = start + access + beats;
        const Service& got = ports.services[port].at(0);
        RC_ASSERT(got.done == free);
        RC_ASSERT(got.wait_interconnect == now - granted.at);
        RC_ASSERT(got.wait_bank == start - sent);
      }
      busy += free - now;
    }
    RC_ASSERT(ports.written == written);
    RC_ASSERT(ports.interconnect->statistics().busy == busy);
  }
}

RC_GTEST_PROP(PortSet, FindsWhatASortedSetFinds, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto ports = static_cast<std::uint32_t>(1 + random() % (random() % 2 == 0 ? 200 : 70'000));
  PortSet set(ports);
  std::set<std::uint32_t> oracle;
  for (int i = 0; i < 300; ++i) {
    const auto port = static_cast<std::uint32_t>(random() % ports);
    if (random() % 2 == 0) {
      set.insert(port);
      oracle.insert(port);
    } else if (const auto at = oracle.lower_bound(port); at != oracle.end()) {
      set.erase(*at);
      oracle.erase(at);
    }
    const auto from = static_cast<std::uint32_t>(random() % (ports + 1));
    const auto found = oracle.lower_bound(from);
    RC_ASSERT(set.empty() == oracle.empty());
    RC_ASSERT(set.at_or_after(from) == (found == oracle.end() ? PortSet::none : *found));
  }
}

}  // namespace
}  // namespace marti::memory
