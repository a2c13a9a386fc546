// Cases of queues: contention towards saturation, against closed forms.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "memory/bank.h"
#include "memory/network.h"
#include "processors/replay/bounds.h"
#include "processors/theory/closed_network.h"
#include "studies/stability/cyclic_machine.h"
#include "studies/stability/hostile.h"
#include "studies/stability/machines.h"

namespace marti::studies::stability {

namespace {

using processors::replay::MachineResult;
using processors::theory::ClosedNetwork;

/// D/D/1//N: every wait, finish and sum in closed form.
CaseOutcome cyclic(const std::vector<std::uint32_t>& node_counts, std::int64_t bank_cycles) {
  constexpr std::int64_t reads = 40;
  double off = 0.0;
  double utilisation = 0.0;
  for (const std::uint32_t nodes : node_counts) {
    const Cyclic machine(nodes, reads, bank_cycles);
    const sim::Ticks n = nodes;
    const MachineResult result = processors::replay::replay(machine.log, machine.machine);
    const sim::Ticks each = machine.wait_of_later_rounds();
    off += static_cast<double>(machine.off(result, reads));
    const double span = static_cast<double>(reads) * static_cast<double>(machine.think + machine.service) +
                        static_cast<double>((n - 1) * machine.service + (reads - 1) * each);
    utilisation = static_cast<double>(n * reads * machine.service) / span;
  }
  return {fmt::format("{:g} ps off; utilisation of the largest {:.4f}", off, utilisation), off, 0.0};
}

/// Far beyond saturation the bus never rests: the frame is its busy time and the first and last computing.
CaseOutcome saturated(std::uint32_t nodes) {
  const Cyclic machine(nodes, 4, 4, 1);
  const MachineResult result = processors::replay::replay(machine.log, machine.machine);
  const sim::Ticks busy = sim::Ticks{nodes} * 5 * machine.service;
  const double slack = static_cast<double>(result.end - busy) /
                       static_cast<double>(machine.think + machine.after + machine.service);
  CaseOutcome outcome{fmt::format("{} nodes, {} events; {:.2f} computings beyond the bus's busy time",
                                  tables::grouped(nodes), tables::grouped(result.events), slack),
                      slack, 1.0};
  outcome.value += slack < 0.0 ? 2.0 : 0.0;
  return outcome;
}

/// The machine repairman by the same recursion in long double, and by mean value analysis, another algorithm.
CaseOutcome repairman(std::uint64_t customers, double think_over_service) {
  const long double a = static_cast<long double>(think_over_service);
  long double blocking = 1.0L;
  long double busy = 0.0L;
  for (std::uint64_t n = 1; n <= customers; ++n) {
    const auto count = static_cast<long double>(n);
    busy = count / (count + a * blocking);
    blocking = a * blocking / (count + a * blocking);
  }
  const double got = processors::theory::repairman_utilisation(customers, think_over_service, 1.0);
  const double mean = processors::theory::mean_values({customers, think_over_service, {1.0}}).throughput;
  // A sum, because the larger of a number and NaN may be the number.
  const double error =
      std::abs(got / static_cast<double>(busy) - 1.0) + std::abs(mean / static_cast<double>(busy) - 1.0);
  return error_within(error, 1e-12, "relative error of utilisation and of mean values");
}

/// K equal queues and no think time: X = N / ((N + K - 1) D), exactly.
CaseOutcome balanced_banks(std::uint64_t customers) {
  constexpr std::size_t banks = 64;
  const ClosedNetwork network{customers, 0.0, std::vector<double>(banks, 3.0)};
  const auto n = static_cast<double>(customers);
  const double expected = n / ((n + static_cast<double>(banks) - 1.0) * 3.0);
  const double got = processors::theory::mean_values(network).throughput;
  return error_within(std::abs(got / expected - 1.0), 1e-12, "relative error");
}

CaseOutcome bounds_hold() {
  Random random(71);
  Tally tally;
  for (int k = 0; k < 2000; ++k) {
    ClosedNetwork network;
    network.customers = 1 + random.below(k % 10 == 0 ? 5000 : 60);
    network.think = std::pow(10.0, random.between(-9.0, 9.0));
    for (std::uint32_t queue = random.below(8) + 1; queue > 0; --queue) {
      network.demands.push_back(std::pow(10.0, random.between(-9.0, 9.0)));
    }
    const double x = processors::theory::mean_values(network).throughput;
    const auto wide = processors::theory::asymptotic_bounds(network);
    const auto narrow = processors::theory::balanced_job_bounds(network);
    const double up = 1.0 + 1e-9;
    tally.add(wide.low <= x * up && x <= wide.high * up && narrow.low <= x * up && x <= narrow.high * up);
  }
  return none_wrong(tally, "networks outside their bounds");
}

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

/// M/D/1: random arrivals at one bank.
CaseOutcome fixed_service(double load, double limit) {
  constexpr std::int64_t service = 10'000;
  memory::Banks bank(one_bank(service));
  Random random(72);
  double now = 0.0;
  for (int k = 0; k < arrivals; ++k) {
    now += exponential(random, static_cast<double>(service) / load);
    (void)bank.access(0, static_cast<sim::Ticks>(now));
  }
  const double mean = static_cast<double>(bank.statistics()[0].waits.sum) / arrivals;
  const double expected = load * static_cast<double>(service) / (2.0 * (1.0 - load));
  return error_within(std::abs(mean / expected - 1.0), limit, "mean wait off by");
}

/// Geo/D/1: in every tick an arrival with the same probability.
CaseOutcome tick_by_tick() {
  constexpr std::int64_t service = 8;
  constexpr double p = 0.1;
  memory::Banks bank(one_bank(service));
  Random random(73);
  for (sim::Ticks now = 0; now < 10 * sim::Ticks{arrivals}; ++now) {
    if (random.unit() < p) {
      (void)bank.access(0, now);
    }
  }
  const memory::WaitStatistics& waits = bank.statistics()[0].waits;
  const double mean = static_cast<double>(waits.sum) / static_cast<double>(waits.count);
  const double expected = p * service * (service - 1) / (2.0 * (1.0 - p * service));
  return error_within(std::abs(mean / expected - 1.0), 0.03, "mean wait off by");
}

/// M/G/1: messages of 1 or 19 bytes on a bus.
CaseOutcome two_sizes(double load, double limit) {
  memory::NetworkConfig config;
  config.kind = memory::NetworkKind::bus;
  config.clock = sim::Clock::from_period(1'000);
  config.width = 1;
  config.hop_cycles = 0;
  const auto network = memory::make_network(config, 2);
  Random random(74);
  const double mean_service = 10.0 * 1'000.0;
  const double square = 0.5 * (1.0 + 19.0 * 19.0) * 1e6;
  double now = 0.0;
  for (int k = 0; k < arrivals; ++k) {
    now += exponential(random, mean_service / load);
    (void)network->send(static_cast<sim::Ticks>(now), 0, 1, random.below(2) == 0 ? 1U : 19U);
  }
  const double mean = static_cast<double>(network->statistics().waits.sum) / arrivals;
  const double expected = load / mean_service * square / (2.0 * (1.0 - load));
  return error_within(std::abs(mean / expected - 1.0), limit, "mean wait off by");
}

/// The area under the queue's length, counted by itself, is the sum of the waits: exactly, in whole ticks.
CaseOutcome littles_law(const CaseSize& size) {
  memory::BankConfig config;
  config.count = 1;
  config.clock = sim::Clock::from_period(1);
  config.access_cycles = 90;
  config.busy_cycles = 97;
  memory::Banks bank(config);
  Random random(75);
  std::vector<std::pair<sim::Ticks, int>> steps;
  double now = 0.0;
  for (std::uint32_t k = 0; k < size.rays; ++k) {
    now += exponential(random, 98.0);
    const auto arrival = static_cast<sim::Ticks>(now);
    steps.emplace_back(arrival, 1);
    steps.emplace_back(bank.access(0, arrival).start, -1);
  }
  std::ranges::sort(steps);
  sim::Ticks area = 0;
  sim::Ticks last = 0;
  std::int64_t length = 0;
  for (const auto& [at, change] : steps) {
    area += length * (at - last);
    length += change;
    last = at;
  }
  const auto off = static_cast<double>(std::llabs(area - sim::ticks_of(bank.statistics()[0].waits.sum)));
  return {fmt::format("{:g} of {} ticks off", off, tables::grouped(static_cast<std::uint64_t>(area))), off,
          0.0};
}

}  // namespace

void add_queue_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::machine);
  add("cyclic-light", "1 to 17 nodes that wait for a bus now and then",
      "D/D/1//N in closed form, to the tick", [] {
        return cyclic({1, 2, 3, 16, 17}, 1);
      });
  add("cyclic-saturated", "64 to 256 nodes on one bus: utilisation towards 1",
      "D/D/1//N in closed form, to the tick", [] {
        return cyclic({64, 256}, 13);
      });
  add("saturated-bus", "the largest machine on one bus, all nodes in one queue",
      "the bus never rests: its busy time plus at most one computing",
      [](const CaseSize& size) { return saturated(size.nodes); });
  for (const auto& [id, customers, ratio] :
       {std::tuple{"repairman-16-1e9", 16, 1e9}, std::tuple{"repairman-1024-1e3", 1024, 1e3},
        std::tuple{"repairman-65536-1e6", 65536, 1e6}, std::tuple{"repairman-65536-1e-3", 65536, 1e-3}}) {
    add(id,
        fmt::format("closed network of {} customers, think over service {:g}: digits cancel", customers,
                    ratio),
        "the recursion in long double, and another algorithm", [customers = customers, ratio = ratio] {
          return repairman(static_cast<std::uint64_t>(customers), ratio);
        });
  }
  add("mean-values-64-banks", "mean values of 65,536 customers at 64 banks lose their digits",
      "N / ((N + K - 1) D), exact", [] { return balanced_banks(65'536); });
  add("network-bounds", "2,000 random networks, times from 1e-9 to 1e9", "asymptotic and balanced-job bounds",
      bounds_hold);
  add("open-fixed-half", "random arrivals at a bank, load 0.5", "Pollaczek-Khinchine (M/D/1)",
      [] { return fixed_service(0.5, 0.01); });
  add("open-fixed-0.9", "random arrivals at a bank, load 0.9", "Pollaczek-Khinchine (M/D/1)",
      [] { return fixed_service(0.9, 0.08); });
  add("open-two-sizes", "messages of two sizes on a bus, load 0.7", "Pollaczek-Khinchine (M/G/1)",
      [] { return two_sizes(0.7, 0.05); });
  add("open-by-tick", "an arrival in every tick by chance, service of 8 ticks", "p D (D - 1) / (2 (1 - p D))",
      tick_by_tick);
  add("littles-law", "waits that are summed apart from the queue they are in",
      "area under the queue's length, in whole ticks", littles_law);
}

}  // namespace marti::studies::stability
