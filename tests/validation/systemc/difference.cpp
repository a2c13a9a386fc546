#include "tests/validation/systemc/difference.h"

#include <algorithm>
#include <string_view>

#include "memory/record_kind.h"
#include "sim/statistics.h"

namespace marti::oracle {

namespace {

class Comparison {
 public:
  void at(std::string place) { place_ = std::move(place); }

  void equal(std::string_view name, sim::Sum replay, sim::Sum systemc) {
    if (replay != systemc) {
      lines.push_back(place_ + " " + std::string(name) + ": replay " +
                      std::to_string(static_cast<double>(replay)) + ", SystemC " +
                      std::to_string(static_cast<double>(systemc)));
    }
  }

  template <sim::HasCounters S>
  void counters(const S& replay, const S& systemc) {
    sim::for_each_counter(replay, [&](const auto& counter, sim::Sum value) {
      equal(counter.name, value, counter.value(systemc));
    });
  }

  template <std::size_t N>
  void arrays(const std::array<std::int64_t, N>& replay, const std::array<std::int64_t, N>& systemc,
              const std::array<std::string_view, N>& names) {
    for (std::size_t i = 0; i < N; ++i) {
      equal(names[i], replay[i], systemc[i]);
    }
  }

  void waits(const memory::WaitStatistics& replay, const WaitTimes& systemc) {
    std::int64_t count = 0;
    Time sum = 0;
    for (const auto& [wait, times] : systemc) {
      count += times;
      sum += wait * times;
    }
    equal("waits", replay.count, count);
    equal("sum of the waits", replay.sum, sum);
    equal("longest wait", replay.max, systemc.empty() ? 0 : systemc.rbegin()->first);
    equal("waits in the histogram", replay.histogram.count(), count);
    for (const sim::LogHistogram::Bucket& bucket : replay.histogram.buckets()) {
      std::int64_t inside = 0;
      for (auto at = systemc.lower_bound(bucket.lowest); at != systemc.end() && at->first <= bucket.highest;
           ++at) {
        inside += at->second;
      }
      equal("waits from " + std::to_string(bucket.lowest) + " to " + std::to_string(bucket.highest),
            bucket.count, inside);
    }
  }

  std::vector<std::string> lines;

 private:
  std::string place_;
};

void compare_nodes(Comparison& compare, const processors::replay::MachineResult& replay,
                   const MachineFigures& systemc) {
  compare.equal("nodes", std::ssize(replay.nodes), std::ssize(systemc.nodes));
  for (std::size_t n = 0; n < std::min(replay.nodes.size(), systemc.nodes.size()); ++n) {
    const std::string node = "node " + std::to_string(n);
    const processors::cost::NodeStatistics& a = replay.nodes[n];
    const processors::cost::NodeStatistics& b = systemc.nodes[n];
    compare.at(node);
    compare.counters(a, b);
    compare.counters(a.steps, b.steps);
    compare.at(node + " time of");
    compare.arrays(a.time, b.time, processors::cost::activity_names);
    compare.at(node + " hits of");
    compare.arrays(a.references.hits, b.references.hits, memory::record_kind_names);
    compare.at(node + " misses of");
    compare.arrays(a.references.misses, b.references.misses, memory::record_kind_names);
  }
}

void compare_clusters(Comparison& compare, const processors::replay::MachineResult& replay,
                      const MachineFigures& systemc) {
  compare.equal("clusters", std::ssize(replay.clusters), std::ssize(systemc.clusters));
  for (std::size_t c = 0; c < std::min(replay.clusters.size(), systemc.clusters.size()); ++c) {
    const std::string cluster = "cluster " + std::to_string(c);
    const processors::replay::ClusterResult& a = replay.clusters[c];
    const ClusterFigures& b = systemc.clusters[c];
    compare.at(cluster);
    compare.counters(a.interconnect, b.interconnect);
    compare.waits(a.interconnect.waits, b.waits);
    compare.equal("banks", std::ssize(a.banks), std::ssize(b.banks));
    for (std::size_t i = 0; i < std::min(a.banks.size(), b.banks.size()); ++i) {
      compare.at(cluster + " bank " + std::to_string(i));
      compare.counters(a.banks[i], b.banks[i].statistics);
      compare.waits(a.banks[i].waits, b.banks[i].waits);
    }
  }
}

}  // namespace

std::vector<std::string> differences(const processors::replay::MachineResult& replay,
                                     const MachineFigures& systemc) {
  Comparison compare;
  compare.at("machine");
  compare.equal("end", replay.end, systemc.end);
  compare.equal("packets", static_cast<std::int64_t>(replay.packets),
                static_cast<std::int64_t>(systemc.packets));
  compare_nodes(compare, replay, systemc);
  compare_clusters(compare, replay, systemc);
  compare.at("host");
  compare.counters(replay.host, systemc.host);
  return compare.lines;
}

}  // namespace marti::oracle
