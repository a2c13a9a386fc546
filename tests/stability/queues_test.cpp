// Queues against closed forms at their extremes: random arrivals, and closed networks whose digits cancel.
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "memory/bank.h"
#include "memory/network.h"
#include "processors/theory/closed_network.h"
#include "tests/contract/hostile.h"

namespace marti::tests {
namespace {

double exponential(Random& random, double mean) { return -mean * std::log(1.0 - random.unit()); }

constexpr int arrivals = 1'000'000;

/// A bank that serves in a fixed time, of so many ticks.
memory::BankConfig one_bank(std::int64_t service) {
  memory::BankConfig config;
  config.count = 1;
  config.clock = sim::Clock::from_period(1);
  config.access_cycles = service;
  config.busy_cycles = service;
  return config;
}

double mean_wait(const memory::WaitStatistics& waits) {
  return static_cast<double>(waits.sum) / static_cast<double>(waits.count);
}

// Pollaczek and Khinchine's mean wait, M/D/1. Nearer to a load of 1 a run would have to be impractically
// long.
TEST(OpenQueues, RandomArrivalsAtABankWaitAsTheyShould) {
  constexpr std::int64_t service = 10'000;
  for (const auto& [load, error] : {std::pair{0.5, 0.01}, {0.9, 0.08}}) {
    memory::Banks bank(one_bank(service));
    Random random(72);
    double now = 0.0;
    for (int k = 0; k < arrivals; ++k) {
      now += exponential(random, static_cast<double>(service) / load);
      (void)bank.access(0, static_cast<sim::Ticks>(now));
    }
    const double expected = load * static_cast<double>(service) / (2.0 * (1.0 - load));
    EXPECT_NEAR(mean_wait(bank.statistics()[0].waits) / expected, 1.0, error);
  }
}

// Geo/D/1: in every tick an arrival with the same probability.
TEST(OpenQueues, ArrivalsByTheTickToo) {
  constexpr std::int64_t service = 8;
  constexpr double p = 0.1;
  memory::Banks bank(one_bank(service));
  Random random(73);
  for (sim::Ticks now = 0; now < 10 * sim::Ticks{arrivals}; ++now) {
    if (random.unit() < p) {
      (void)bank.access(0, now);
    }
  }
  const double expected = p * service * (service - 1) / (2.0 * (1.0 - p * service));
  EXPECT_NEAR(mean_wait(bank.statistics()[0].waits) / expected, 1.0, 0.03);
}

// M/G/1: messages of 1 or 19 bytes on a bus.
TEST(OpenQueues, MessagesOfTwoSizesToo) {
  constexpr double load = 0.7;
  memory::NetworkConfig config;
  config.kind = memory::NetworkKind::bus;
  config.clock = sim::Clock::from_period(1'000);
  config.width = 1;
  config.hop_cycles = 0;
  const auto network = memory::make_network(config, 2);
  Random random(74);
  constexpr double mean_service = 10.0 * 1'000.0;
  constexpr double square = 0.5 * (1.0 + 19.0 * 19.0) * 1e6;
  double now = 0.0;
  for (int k = 0; k < arrivals; ++k) {
    now += exponential(random, mean_service / load);
    (void)network->send(static_cast<sim::Ticks>(now), 0, 1, random.below(2) == 0 ? 1U : 19U);
  }
  const double expected = load / mean_service * square / (2.0 * (1.0 - load));
  EXPECT_NEAR(mean_wait(network->statistics().waits) / expected, 1.0, 0.05);
}

// The machine repairman by the same recursion in long double, and by mean value analysis, another algorithm.
TEST(LargeNetworks, TheRepairmanKeepsHisDigits) {
  for (const auto& [customers, ratio] :
       {std::pair<std::uint64_t, double>{16, 1e9}, {1024, 1e3}, {65536, 1e6}, {65536, 1e-3}}) {
    const auto a = static_cast<long double>(ratio);
    long double blocking = 1.0L;
    long double busy = 0.0L;
    for (std::uint64_t n = 1; n <= customers; ++n) {
      const auto count = static_cast<long double>(n);
      busy = count / (count + a * blocking);
      blocking = a * blocking / (count + a * blocking);
    }
    const auto expected = static_cast<double>(busy);
    EXPECT_NEAR(processors::theory::repairman_utilisation(customers, ratio, 1.0) / expected, 1.0, 1e-12);
    EXPECT_NEAR(processors::theory::mean_values({customers, ratio, {1.0}}).throughput / expected, 1.0, 1e-12);
  }
}

// K equal queues and no think time: X = N / ((N + K - 1) D), exactly.
TEST(LargeNetworks, ManyBanksAreServedAsTheyShouldBe) {
  const processors::theory::ClosedNetwork network{65'536, 0.0, std::vector<double>(64, 3.0)};
  EXPECT_NEAR(processors::theory::mean_values(network).throughput * (65'536.0 + 63.0) * 3.0 / 65'536.0, 1.0,
              1e-12);
}

}  // namespace
}  // namespace marti::tests
