// A memory that is spread over the nodes: messages by hand, and against a second implementation that sorts
// all arrivals.
#include "memory/distributed.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

#include "sim/error.h"
#include "tests/support/memory_ports.h"

namespace marti::memory {
namespace {

using marti::test::memory_class;
using Issue = marti::test::IssuedTransaction;

class DistributedPorts final : public marti::test::Ports {
 public:
  DistributedPorts(const DistributedConfig& config, std::vector<Issue> issues, std::uint32_t ports)
      : marti::test::Ports(
            [&](const InterconnectSite& site) { return std::make_unique<Distributed>(config, site); },
            std::move(issues), ports),
        memory(dynamic_cast<const Distributed&>(*interconnect)) {}

  const Distributed& memory;
};

// Four nodes in a mesh of 2 x 2; a hop is 20, a beat of 4 bytes 10; a memory takes 40 and 10 for 8 bytes.
DistributedConfig four_nodes() {
  DistributedConfig config;
  config.nodes = 4;
  config.clock = sim::Clock::from_period(10);
  config.network.clock = sim::Clock::from_period(10);
  return config;
}

TEST(Distributed, AnothersMemoryTakesARequestAndItsData) {
  // Node 3 is two hops from node 0. The request: 2 hops and 2 beats; the data: 2 hops and (8 + 32) / 4 beats.
  DistributedPorts ports(four_nodes(), {{0, {0, 96, 32}}}, 4);
  const Service& service = ports.services[0][0];
  EXPECT_EQ(service.done, (40 + 20) + (40 + 40) + (40 + 100));
  EXPECT_EQ(service.bank, 40);
  EXPECT_EQ(service.transfer, 60 + 40 + 140);
  EXPECT_EQ(service.wait_bank + service.wait_interconnect, 0);
  EXPECT_EQ(ports.memory.network_statistics()->messages, 2);
  EXPECT_EQ(ports.memory.network_statistics()->bytes, 8 + 40);
  EXPECT_EQ(ports.memory.statistics().busy, 2 * 20 + 2 * 100);
  EXPECT_EQ(ports.memory.bank_statistics()[3].accesses, 1);
  // Homes 0 to 3 of node 0: 80 of memory each, and messages over 0, 1, 1 and 2 hops.
  EXPECT_EQ(ports.memory.unloaded_read(32), 80 + (2 * (40 + 120) + (80 + 120)) / 4);
}

TEST(Distributed, AWriteIsDoneWhenItsHomeHasIt) {
  DistributedPorts ports(four_nodes(), {{0, {0, 32, 4}, true}}, 4);
  EXPECT_EQ(ports.written[0][0], 20 + 30 + 40 + 10) << "one hop, 12 bytes of message, access and a beat";
  EXPECT_EQ(ports.memory.network_statistics()->messages, 1);
}

// With an ideal network each access reaches its home a known time after it was made, so all arrivals can be
// listed, sorted and served.
RC_GTEST_PROP(Distributed, EqualsAListOfArrivalsOverAnIdealNetwork, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto pick = [&](std::int64_t lo, std::int64_t hi) {
    return lo + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(hi - lo + 1));
  };
  DistributedConfig config;
  config.nodes = static_cast<std::uint32_t>(pick(1, 9));
  config.interleave = 1U << pick(3, 7);
  config.clock = sim::Clock::from_period(pick(1, 30));
  config.width = static_cast<std::uint32_t>(pick(1, 16));
  config.access_cycles = pick(0, 5);
  config.cycles_per_beat = pick(0, 2);
  config.network.kind = NetworkKind::ideal;
  config.network.clock = sim::Clock::from_period(pick(1, 30));
  config.network.hop_cycles = pick(1, 6);
  const std::uint32_t ports_per_node = 12;
  const std::uint32_t all = config.nodes * ports_per_node;
  const sim::Ticks hop = config.network.clock.cycles(config.network.hop_cycles);

  struct Access {
    Issue issue;
    bool remote = false;
    std::uint32_t home = 0;
    sim::Ticks arrival = 0;
    std::uint32_t sequence = 0;
    sim::Ticks done = 0;
  };
  std::vector<Issue> issues;
  std::vector<Access> accesses;
  std::vector<std::uint32_t> writes(all);
  sim::Ticks now = 0;
  // Each port reads at most once; the first port of each node writes, as often as it likes.
  for (std::uint32_t i = 0; i < all; ++i) {
    now += pick(0, 3) == 0 ? pick(0, 300) : 0;
    const bool write = pick(0, 2) == 0;
    const std::uint32_t port = write ? i / ports_per_node * ports_per_node : i;
    const Issue issue = {
        now, {port, static_cast<Address>(pick(0, 2000)) * 8, static_cast<std::uint32_t>(pick(1, 8))}, write};
    issues.push_back(issue);
    Access access{issue, false, 0, 0, 0, 0};
    access.home = static_cast<std::uint32_t>(issue.transaction.address / config.interleave % config.nodes);
    access.remote = access.home != port / ports_per_node;
    access.arrival = now + (access.remote ? hop : 0);
    access.sequence = write ? 1 + writes[port]++ : 0;
    accesses.push_back(access);
  }
  const DistributedPorts ports(config, issues, all);

  // At one instant: own accesses first (reads and writes in the order made), then messages by port.
  const auto rank = [](const Access& a) {
    return std::tuple(a.arrival, a.remote, a.issue.transaction.port, a.remote ? a.sequence : 0);
  };
  std::stable_sort(accesses.begin(), accesses.end(),
                   [&](const Access& a, const Access& b) { return rank(a) < rank(b); });
  std::vector<sim::Ticks> free(config.nodes);
  std::vector<sim::Ticks> waits(config.nodes);
  std::vector<std::vector<std::pair<std::uint32_t, sim::Ticks>>> written(all);
  std::int64_t remote = 0;
  for (Access& access : accesses) {
    const std::int64_t beats = (access.issue.transaction.bytes + config.width - 1) / config.width;
    const sim::Ticks start = std::max(access.arrival, free[access.home]);
    waits[access.home] += start - access.arrival;
    free[access.home] = start + config.clock.cycles(config.access_cycles + beats * config.cycles_per_beat);
    access.done = free[access.home];
    remote += access.remote ? 1 : 0;
    const std::uint32_t port = access.issue.transaction.port;
    if (access.issue.write) {
      written[port].emplace_back(access.sequence, access.done);
    } else {
      access.done += access.remote ? hop : 0;
      RC_ASSERT(ports.services[port].size() == 1U);
      const Service& got = ports.services[port][0];
      RC_ASSERT(got.done == access.done);
      RC_ASSERT(got.wait_bank == start - access.arrival);
      RC_ASSERT(got.wait_interconnect + got.transfer + got.wait_bank + got.bank ==
                access.done - access.issue.at);
    }
  }
  for (std::uint32_t port = 0; port < all; ++port) {
    std::sort(written[port].begin(), written[port].end());
    RC_ASSERT(ports.written[port].size() == written[port].size());
    for (std::size_t i = 0; i < written[port].size(); ++i) {
      RC_ASSERT(ports.written[port][i] == written[port][i].second);
    }
  }
  for (std::uint32_t home = 0; home < config.nodes; ++home) {
    RC_ASSERT(ports.memory.bank_statistics()[home].waits.sum == waits[home]);
  }
  const DistributedStatistics& counted = *ports.memory.distribution();
  RC_ASSERT(counted.remote_reads + counted.remote_writes == remote);
  RC_ASSERT(ports.memory.network_statistics()->messages == 2 * counted.remote_reads + counted.remote_writes);
}

TEST(Distributed, RefusesWhatCannotBeSpread) {
  sim::Engine engine;
  DistributedPorts client(four_nodes(), {}, 4);
  for (const auto& spoil :
       {+[](DistributedConfig& c) { c.width = 0; }, +[](DistributedConfig& c) { c.interleave = 48; },
        +[](DistributedConfig& c) { c.header_bytes = 0; },
        +[](DistributedConfig& c) { c.network.width = 0; }}) {
    DistributedConfig config = four_nodes();
    spoil(config);
    EXPECT_THROW(Distributed(config, {engine, client, 0, 0, 4, memory_class}), sim::UserError);
  }
}

}  // namespace
}  // namespace marti::memory
