// Results of two replays that must not differ.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "processors/replay/replay.h"
#include "sim/statistics.h"

namespace marti::test {

template <class S>
void expect_equal_counters(const S& a, const S& b) {
  sim::for_each_counter(a, [&](const sim::Counter<S>& counter, sim::Sum value) {
    ASSERT_TRUE(value == counter.value(b)) << counter.name;
  });
}

template <class S>
void expect_equal_counters(const std::vector<S>& a, const std::vector<S>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    expect_equal_counters(a[i], b[i]);
  }
}

/// Equal times, packets, references and steps of every node, and equal counters and waits of all that nodes
/// share and of what they hand to each other.
inline void expect_equal(const processors::replay::MachineResult& a,
                         const processors::replay::MachineResult& b) {
  ASSERT_EQ(a.end, b.end);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    ASSERT_EQ(a.nodes[n].time, b.nodes[n].time) << "node " << n;
    ASSERT_EQ(a.nodes[n].references.hits, b.nodes[n].references.hits) << "node " << n;
    ASSERT_EQ(a.nodes[n].references.misses, b.nodes[n].references.misses) << "node " << n;
    ASSERT_EQ(a.nodes[n].finish, b.nodes[n].finish) << "node " << n;
    expect_equal_counters(a.nodes[n].steps, b.nodes[n].steps);
  }
  expect_equal_counters(a.nodes, b.nodes);
  ASSERT_EQ(a.clusters.size(), b.clusters.size());
  for (std::size_t c = 0; c < a.clusters.size(); ++c) {
    const memory::InterconnectStatistics& x = a.clusters[c].interconnect;
    const memory::InterconnectStatistics& y = b.clusters[c].interconnect;
    expect_equal_counters(x, y);
    expect_equal_counters(x.waits, y.waits);
    ASSERT_EQ(x.waits.histogram.percentile(95), y.waits.histogram.percentile(95));
    ASSERT_EQ(x.waits.histogram.count(), y.waits.histogram.count());
    ASSERT_EQ(a.clusters[c].banks.size(), b.clusters[c].banks.size());
    for (std::size_t i = 0; i < a.clusters[c].banks.size(); ++i) {
      expect_equal_counters(a.clusters[c].banks[i].waits, b.clusters[c].banks[i].waits);
      ASSERT_EQ(a.clusters[c].banks[i].accesses, b.clusters[c].banks[i].accesses);
    }
  }
  expect_equal_counters(a.l2.caches, b.l2.caches);
  ASSERT_EQ(a.build.start_up, b.build.start_up);
  expect_equal_counters(a.build.nodes, b.build.nodes);
  expect_equal_counters(a.build.levels, b.build.levels);
  expect_equal_counters(a.flow.nodes, b.flow.nodes);
  expect_equal_counters(a.flow.networks, b.flow.networks);
  ASSERT_EQ(a.flow.networks.size(), b.flow.networks.size());
  for (std::size_t c = 0; c < a.flow.networks.size(); ++c) {
    expect_equal_counters(a.flow.networks[c].waits, b.flow.networks[c].waits);
  }
  ASSERT_EQ(a.flow.rays, b.flow.rays);
  ASSERT_EQ(a.flow.collected, b.flow.collected);
  ASSERT_EQ(a.flow.most_in_flight, b.flow.most_in_flight);
  ASSERT_EQ(a.flow.regions, b.flow.regions);
  ASSERT_EQ(a.flow.top_nodes, b.flow.top_nodes);
  ASSERT_EQ(a.flow.duplicated_primitives, b.flow.duplicated_primitives);
  ASSERT_EQ(a.flow.memory_bytes, b.flow.memory_bytes);
  ASSERT_EQ(a.flow.sampling_work, b.flow.sampling_work);
  expect_equal_counters(a.contexts.nodes, b.contexts.nodes);
  expect_equal_counters(a.host, b.host);
}

/// Equal counts beyond hits and misses, as far as they were asked for.
inline void expect_equal_counts(const processors::walk::CacheCountResult& a,
                                const processors::walk::CacheCountResult& b) {
  ASSERT_EQ(a.miss_classes, b.miss_classes);
  ASSERT_EQ(a.sharing.has_value(), b.sharing.has_value());
  if (a.sharing) {
    ASSERT_EQ(a.sharing->fetches, b.sharing->fetches);
    ASSERT_EQ(a.sharing->distinct, b.sharing->distinct);
    ASSERT_EQ(a.sharing->fetched, b.sharing->fetched);
  }
  ASSERT_EQ(a.attribution.has_value(), b.attribution.has_value());
  if (a.attribution) {
    const auto place = [](const processors::walk::AttributionRow& row) {
      return std::tuple(row.bounce, row.ray, row.splitting, row.level, row.record);
    };
    ASSERT_EQ(a.attribution->size(), b.attribution->size());
    for (std::size_t row = 0; row < a.attribution->size(); ++row) {
      ASSERT_EQ(place((*a.attribution)[row]), place((*b.attribution)[row]));
      expect_equal_counters((*a.attribution)[row].counts, (*b.attribution)[row].counts);
    }
  }
}

}  // namespace marti::test
