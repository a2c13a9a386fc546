// Results of two replays that must not differ.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "processors/replay.h"

namespace marti::test {

/// Equal times, packets and references of every node, and equal counters and waits of all that nodes share.
inline void expect_equal(const processors::MachineResult& a, const processors::MachineResult& b) {
  ASSERT_EQ(a.end, b.end);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    ASSERT_EQ(a.nodes[n].time, b.nodes[n].time) << "node " << n;
    ASSERT_EQ(a.nodes[n].references.hits, b.nodes[n].references.hits) << "node " << n;
    ASSERT_EQ(a.nodes[n].references.misses, b.nodes[n].references.misses) << "node " << n;
    ASSERT_EQ(a.nodes[n].finish, b.nodes[n].finish) << "node " << n;
    ASSERT_EQ(a.nodes[n].packets, b.nodes[n].packets) << "node " << n;
  }
  ASSERT_EQ(a.clusters.size(), b.clusters.size());
  for (std::size_t c = 0; c < a.clusters.size(); ++c) {
    const memory::InterconnectStatistics& x = a.clusters[c].interconnect;
    const memory::InterconnectStatistics& y = b.clusters[c].interconnect;
    ASSERT_EQ(x.reads, y.reads);
    ASSERT_EQ(x.writes, y.writes);
    ASSERT_EQ(x.bytes, y.bytes);
    ASSERT_EQ(x.busy, y.busy);
    ASSERT_EQ(x.waits.count, y.waits.count);
    ASSERT_EQ(x.waits.sum, y.waits.sum);
    ASSERT_EQ(x.waits.max, y.waits.max);
    ASSERT_EQ(x.waits.histogram.percentile(95), y.waits.histogram.percentile(95));
    ASSERT_EQ(x.waits.histogram.count(), y.waits.histogram.count());
    ASSERT_EQ(a.clusters[c].banks.size(), b.clusters[c].banks.size());
    for (std::size_t i = 0; i < a.clusters[c].banks.size(); ++i) {
      ASSERT_EQ(a.clusters[c].banks[i].waits.sum, b.clusters[c].banks[i].waits.sum);
      ASSERT_EQ(a.clusters[c].banks[i].accesses, b.clusters[c].banks[i].accesses);
    }
  }
  ASSERT_EQ(a.l2.caches.size(), b.l2.caches.size());
  for (std::size_t i = 0; i < a.l2.caches.size(); ++i) {
    ASSERT_EQ(a.l2.caches[i].hits, b.l2.caches[i].hits);
    ASSERT_EQ(a.l2.caches[i].misses, b.l2.caches[i].misses);
  }
}

}  // namespace marti::test
