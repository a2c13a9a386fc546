// Where two results of the same machine differ, in words.
#pragma once

#include <string>
#include <vector>

#include "processors/replay/replay.h"
#include "sim/statistics.h"

namespace marti::test {

/// Names the figures that differ, a line each, up to a few; empty if none does. All figures but those of how
/// the result was computed (events, bytes of the host, what was left out), of energy, and of machines that
/// SIMT nodes cannot be part of.
class FirstDifference {
 public:
  static std::string between(const processors::replay::MachineResult& a,
                             const processors::replay::MachineResult& b) {
    FirstDifference all;
    all.compare(a, b);
    return all.text_;
  }

 private:
  void figure(const std::string& name, sim::Sum a, sim::Sum b) {
    if (a != b && ++found_ <= most) {
      text_ += name + ": " + std::to_string(static_cast<std::int64_t>(a)) + " and " +
               std::to_string(static_cast<std::int64_t>(b)) + "\n";
    }
  }
  template <class S>
  void counters(const std::string& name, const S& a, const S& b) {
    for (const auto& counter : S::counters()) {
      figure(name + "." + std::string(counter.name), counter.value(a), counter.value(b));
    }
  }
  void waits(const std::string& name, const memory::WaitStatistics& a, const memory::WaitStatistics& b) {
    counters(name, a, b);
    figure(name + ".p95", a.histogram.percentile(95).value_or(-1), b.histogram.percentile(95).value_or(-1));
  }
  template <class T, class Each>
  void list(const std::string& name, const std::vector<T>& a, const std::vector<T>& b, const Each& each) {
    figure("number of " + name, a.size(), b.size());
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
      each(name + "[" + std::to_string(i) + "]", a[i], b[i]);
    }
  }

  void compare(const processors::replay::MachineResult& a, const processors::replay::MachineResult& b) {
    using namespace processors;
    figure("end", a.end, b.end);
    counters("host", a.host, b.host);
    list("nodes", a.nodes, b.nodes, [&](const std::string& name, const auto& x, const auto& y) {
      counters(name, x, y);
      counters(name + ".steps", x.steps, y.steps);
      for (std::size_t i = 0; i < memory::record_kinds; ++i) {
        const std::string kind(memory::record_kind_names[i]);
        figure(name + ".misses." + kind, x.references.misses[i], y.references.misses[i]);
        figure(name + ".hits." + kind, x.references.hits[i], y.references.hits[i]);
      }
      for (std::size_t i = 0; i < cost::activities; ++i) {
        figure(name + ".time." + std::string(cost::activity_names[i]), x.time[i], y.time[i]);
      }
    });
    list("simt", a.simt.nodes, b.simt.nodes,
         [&](const std::string& name, const auto& x, const auto& y) { counters(name, x, y); });
    list("prefetches", a.contexts.nodes, b.contexts.nodes,
         [&](const std::string& name, const auto& x, const auto& y) { counters(name, x, y); });
    list("clusters", a.clusters, b.clusters, [&](const std::string& name, const auto& x, const auto& y) {
      counters(name, x.interconnect, y.interconnect);
      waits(name + ".waits", x.interconnect.waits, y.interconnect.waits);
      list(name + ".banks", x.banks, y.banks, [&](const std::string& bank, const auto& u, const auto& v) {
        counters(bank, u, v);
        waits(bank + ".waits", u.waits, v.waits);
      });
      list(name + ".dram", x.dram, y.dram,
           [&](const std::string& channel, const auto& u, const auto& v) { counters(channel, u, v); });
    });
    list("l2", a.l2.caches, b.l2.caches,
         [&](const std::string& name, const auto& x, const auto& y) { counters(name, x, y); });
    list("l2.waits", a.l2.waits, b.l2.waits,
         [&](const std::string& name, const auto& x, const auto& y) { waits(name, x, y); });
    figure("packets", a.packets, b.packets);
    figure("pixels", a.pixels, b.pixels);
    figure("database bytes", a.database_bytes, b.database_bytes);
    figure("copies", a.copies, b.copies);
    figure("leaf records", a.leaf_records, b.leaf_records);
    figure("unloaded miss", a.unloaded_miss, b.unloaded_miss);
  }

  static constexpr int most = 12;
  int found_ = 0;
  std::string text_;
};

}  // namespace marti::test
