#include "studies/estimate/simulator_analytic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <random>

#include "processors/cost/step_time.h"
#include "processors/passes/one_pass.h"
#include "processors/replay/replay.h"
#include "sim/key_error.h"
#include "studies/estimate/tenures.h"

namespace marti::studies::estimate {

using processors::machine::MachineConfig;

namespace {

// The part of the frame that does not depend on the cache.
struct PacketsWork {
  double scale = 1.0;  // the whole frame over the part that was walked
  std::vector<std::uint64_t> words;
  double packets = 0.0;
  double writes = 0.0;
  double dispatch = 0.0;  // to dispatch a packet
};

sim::Ticks compute_ticks(const MachineConfig& machine, const processors::program::WorkLog& log,
                         const processors::cost::StepCounts& steps, std::int64_t hits) {
  processors::cost::TimeDivision time{};
  processors::cost::add_counted_time(processors::cost::step_ticks(machine, log), steps, hits, time);
  return processors::cost::sum_of(time);
}

// Contention of the nodes, as customers of a closed network.
struct Contention {
  double interconnect = 0.0;   // busy time of the bus
  double wait = 0.0;           // mean, of a request for the bus, when all nodes work
  std::vector<double> speeds;  // [n - 1]: of each of n busy nodes; 1 without contention
};

Contention contention_of(const MachineConfig& machine, const Tenures& tenures, const PacketsWork& work,
                         double alone, double misses) {
  Contention contention;
  contention.interconnect = misses * tenures.read + work.writes * tenures.write;
  const auto nodes =
      static_cast<std::size_t>(std::min(static_cast<double>(machine.all_nodes()), work.packets));
  contention.speeds.assign(nodes, 1.0);
  if (!tenures.bus || misses == 0.0) {
    return contention;
  }
  // One cycle of the network is one miss. What posted writes demand of the queues is added to the cycle that
  // they belong to, and its think time is shorter by as much (as in replay::predict()).
  std::vector<double> demands = {contention.interconnect / misses};
  if (tenures.bank_busy > 0.0) {
    const double each = (misses + work.writes) * tenures.bank_busy / machine.banks.count / misses;
    demands.insert(demands.end(), machine.banks.count, each);
  }
  const double demand = std::accumulate(demands.begin(), demands.end(), 0.0);
  const double cycle = (alone + work.packets * work.dispatch) / misses;
  const double think = std::max(0.0, cycle - demand);
  // Exact mean values, one customer more at a time (Reiser and Lavenberg 1980); throughputs of all numbers of
  // customers are needed, which theory::mean_values() does not give.
  std::vector<double> queues(demands.size(), 0.0);
  for (std::size_t n = 1; n <= nodes; ++n) {
    double around = think;
    for (std::size_t k = 0; k < demands.size(); ++k) {
      queues[k] = demands[k] * (1.0 + queues[k]);
      around += queues[k];
    }
    contention.wait = queues[0] - demands[0];
    for (double& queue : queues) {
      queue *= static_cast<double>(n) / around;
    }
    contention.speeds[n - 1] = std::min(1.0, (think + demand) / around);
  }
  contention.wait *= misses / (misses * tenures.per_read + work.writes);
  return contention;
}

// The frame's end. `alone`, the time of all packets without contention, is divided among the packets in
// proportion to their words; while n nodes are busy, each runs at the speed of n nodes.
double frame_end(const MachineConfig& machine, const PacketsWork& work, double alone,
                 const Contention& contention) {
  const auto words = static_cast<double>(std::accumulate(work.words.begin(), work.words.end(), 0ULL));
  const auto time_of = [&](std::size_t packet) {
    return work.dispatch + (words > 0.0 ? alone * static_cast<double>(work.words[packet]) / words : 0.0);
  };
  // When each node with a packet is free, by a clock that runs at the nodes' common speed.
  std::priority_queue<double, std::vector<double>, std::greater<>> free;
  std::size_t packet = 0;
  while (packet < std::min<std::size_t>(machine.all_nodes(), work.words.size())) {
    free.push(time_of(packet++));
  }
  double clock = 0.0;
  double end = 0.0;
  while (!free.empty()) {
    const double next = free.top();
    end += (next - clock) / contention.speeds[free.size() - 1];
    clock = next;
    free.pop();
    if (packet < work.words.size()) {
      free.push(clock + time_of(packet++));
    }
  }
  return end;
}

// The packets of each of `walked` nodes out of `nodes`: one of every `nodes` consecutive packets for each
// node. If all nodes are walked, node i has every nodes-th packet from i on; if fewer, packets are drawn at
// random, because packets at a fixed distance often lie below each other in the image.
std::vector<std::vector<std::uint64_t>> packets_to_walk(std::uint64_t packets, std::uint64_t nodes,
                                                        std::uint64_t walked) {
  std::mt19937_64 random(1);
  std::vector<std::vector<std::uint64_t>> of_node(walked);
  for (std::uint64_t first = 0; first < packets; first += nodes) {
    std::uint64_t left = walked;
    for (std::uint64_t i = 0; i < nodes && left > 0; ++i) {
      // Selection sampling (Knuth 3.4.2 S). An incomplete last group is drawn from as if it were complete.
      if (random() % (nodes - i) < left) {
        --left;
        if (first + i < packets) {
          of_node[walked - 1 - left].push_back(first + i);
        }
      }
    }
  }
  return of_node;
}

}  // namespace

void check_analytic(const MachineConfig& machine) {
  processors::replay::check_sampled(machine);
  const auto refuse = [](const char* key, const std::string& reason) {
    throw sim::KeyError(key, "the analytic model is for " + reason + " only");
  };
  if (machine.clusters > 1) {
    refuse("machine.clusters", "one cluster");
  }
  if (machine.placement != processors::machine::Placement::shared) {
    refuse("database.placement", "database.placement = \"shared\"");
  }
  if (machine.cache.organisation != processors::machine::CacheOrganisation::unified ||
      machine.cache.cache.replacement != memory::Replacement::lru) {
    refuse(machine.cache.organisation != processors::machine::CacheOrganisation::unified
               ? "cache.organisation"
               : "cache.replacement",
           "unified LRU caches");
  }
  if (machine.banks.dram) {
    refuse("memory.model", "memory.model = \"fixed\", whose accesses all take the same time,");
  }
  if (machine.interconnect.kind == memory::InterconnectKind::crossbar ||
      (machine.interconnect.kind == memory::InterconnectKind::bus &&
       machine.interconnect.arbitration != memory::Arbitration::fifo)) {
    refuse("interconnect.kind", "an ideal interconnect or a bus that serves first come, first served");
  }
}

std::vector<Estimate> estimate_analytically(const processors::program::WorkLog& log,
                                            const MachineConfig& machine,
                                            std::span<const memory::CacheShape> caches,
                                            const AnalyticOptions& options) {
  check_analytic(machine);
  PacketsWork work;
  work.words = processors::passes::words_of_packets(log, machine.packets);
  work.packets = static_cast<double>(work.words.size());
  work.writes = static_cast<double>(log.width) * static_cast<double>(log.height);
  work.dispatch = static_cast<double>(machine.host.clock.cycles(machine.host.latency_cycles));
  const std::uint64_t nodes = std::min<std::uint64_t>(machine.all_nodes(), work.words.size());
  const std::uint64_t walked = std::min<std::uint64_t>(std::max(options.walked_nodes, 1U), nodes);
  const std::vector<std::vector<std::uint64_t>> packets = packets_to_walk(work.words.size(), nodes, walked);
  const processors::passes::OnePass pass = processors::passes::one_pass(log, machine, caches, packets);
  const auto all_words = static_cast<double>(std::accumulate(work.words.begin(), work.words.end(), 0ULL));
  work.scale = pass.words > 0 ? all_words / static_cast<double>(pass.words) : 1.0;

  const Tenures tenures = tenures_of(machine);
  std::vector<Estimate> estimates;
  for (const std::int64_t missed : pass.misses) {
    const double misses = work.scale * static_cast<double>(missed);
    const double compute =
        work.scale * static_cast<double>(compute_ticks(machine, log, pass.steps, pass.references - missed));
    const double alone = compute + misses * tenures.miss;
    const Contention contention = contention_of(machine, tenures, work, alone, misses);
    // One node's packets follow one another, so its time need not be divided among them.
    const double end = machine.all_nodes() == 1 ? alone + work.packets * work.dispatch
                                                : frame_end(machine, work, alone, contention);
    Estimate estimate;
    // The last pixel is written while its node asks for another packet in vain.
    estimate.value[Figure::end] = end + static_cast<double>(work.packets > 0 ? tenures.last_write : 0);
    estimate.value[Figure::misses] = misses;
    estimate.value[Figure::use] = estimate.value[Figure::end] > 0.0
                                      ? std::min(1.0, contention.interconnect / estimate.value[Figure::end])
                                      : 0.0;
    estimate.value[Figure::wait] = contention.wait;
    estimate.references = work.scale * static_cast<double>(pass.references);
    estimate.words = pass.words;
    estimates.push_back(estimate);
  }
  return estimates;
}

}  // namespace marti::studies::estimate
