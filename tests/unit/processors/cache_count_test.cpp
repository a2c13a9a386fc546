// Second-level caches, classes of misses, sharing and attribution against counts made from the log's
// references one by one, and nodes that count against nodes that do not.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "memory/cache.h"
#include "processors/replay/replay.h"
#include "processors/walk/node_caches.h"
#include "sim/error.h"
#include "tests/support/random_machine.h"
#include "tests/support/traced_lines.h"

namespace marti::processors {
namespace {

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::size_t>;

struct Expected {
  std::array<std::array<std::int64_t, memory::miss_classes>, memory::record_kinds> classes{};
  std::map<Key, std::array<std::int64_t, 3>> cells;  // references, misses, second-level hits
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::set<std::uint32_t>> users;  // of (cluster, line)
  std::int64_t fetches = 0;
  std::vector<std::int64_t> second_misses;
};

// `cache` holds at most `lines` lines, the newest first.
bool find_in_full(std::vector<std::uint32_t>& cache, std::uint64_t lines, std::uint32_t line) {
  const auto at = std::find(cache.begin(), cache.end(), line);
  const bool hit = at != cache.end();
  if (hit) {
    cache.erase(at);
  }
  cache.insert(cache.begin(), line);
  if (cache.size() > lines) {
    cache.pop_back();
  }
  return hit;
}

Expected expect(const WorkLog& log, const MachineConfig& machine) {
  Expected expected;
  const bool split = machine.cache.organisation == CacheOrganisation::split;
  const memory::Address line_bytes = machine.cache.cache.line;
  for (std::uint32_t node = 0; node < machine.all_nodes(); ++node) {
    std::vector<memory::Cache> caches;
    std::vector<std::uint64_t> sizes = {machine.cache.cache.size};
    if (split) {
      sizes.assign(machine.cache.split_sizes.begin(), machine.cache.split_sizes.end());
    }
    for (const std::uint64_t size : sizes) {
      memory::CacheConfig part = machine.cache.cache;
      part.size = size;
      caches.emplace_back(part);
    }
    memory::CacheConfig second = machine.l2.cache;
    second.line = machine.cache.cache.line;
    memory::Cache behind(second);
    std::array<std::vector<std::uint32_t>, split_caches> full;
    std::array<std::set<std::uint32_t>, split_caches> had;
    for (const test::TracedLine& reference : test::trace_node(log, machine, node)) {
      const auto kind = static_cast<std::size_t>(reference.kind);
      const std::size_t at = split ? split_cache_of[kind] : 0;
      const bool hit = caches[at].read(reference.line * line_bytes, 1) == 0;
      const bool in_full = find_in_full(full[at], sizes[at] / line_bytes, reference.line);
      auto& cell = expected.cells[Key{reference.ray / 4, reference.ray % 4, reference.level, kind}];
      ++cell[0];
      if (hit) {
        continue;
      }
      ++cell[1];
      if (machine.l2.sharing == SecondLevel::private_caches) {
        cell[2] += behind.read(reference.line * line_bytes, 1) == 0 ? 1 : 0;
      }
      const bool first = had[at].insert(reference.line).second;
      const memory::MissClass why = first     ? memory::MissClass::compulsory
                                    : in_full ? memory::MissClass::conflict
                                              : memory::MissClass::capacity;
      ++expected.classes[kind][static_cast<std::size_t>(why)];
      expected.users[{node / machine.nodes, reference.line}].insert(node);
      ++expected.fetches;
    }
    expected.second_misses.push_back(behind.counters().misses);
  }
  return expected;
}

constexpr CountConfig everything{true, true, true};

// A random machine with caches whose nodes always get the same packets.
MachineConfig random_counting_machine(test::Random& random) {
  MachineConfig machine = test::random_machine(random);
  if (machine.cache.organisation == CacheOrganisation::none) {
    machine.cache.organisation = CacheOrganisation::unified;
    machine.distribution.interleave = std::max(machine.distribution.interleave, machine.cache.cache.line);
  }
  machine.host.assignment = Assignment::interleaved;
  test::add_random_second_level(random, machine);
  // The victims of random replacement are drawn for each node anew.
  for (memory::CacheConfig* cache : {&machine.cache.cache, &machine.l2.cache}) {
    if (cache->replacement == memory::Replacement::random) {
      cache->replacement = memory::Replacement::fifo;
    }
  }
  machine.count = everything;
  return machine;
}

RC_GTEST_PROP(CacheCount, EveryCountIsThatOfTheReferencesOneByOne, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 9, 9);
  const MachineConfig machine = random_counting_machine(random);
  const MachineResult result = replay(log, machine);
  const Expected expected = expect(log, machine);
  RC_ASSERT(result.counts.miss_classes == expected.classes);
  RC_ASSERT(result.counts.sharing->fetches == expected.fetches);
  RC_ASSERT(result.counts.sharing->distinct == static_cast<std::int64_t>(expected.users.size()));
  std::map<std::uint32_t, std::int64_t> fetched;
  for (const auto& [line, nodes] : expected.users) {
    ++fetched[static_cast<std::uint32_t>(nodes.size())];
  }
  RC_ASSERT(result.counts.sharing->fetched == fetched);
  RC_ASSERT(result.counts.attribution->size() == expected.cells.size());
  auto cell = expected.cells.begin();
  for (const AttributionRow& row : *result.counts.attribution) {
    const Key key{row.bounce, static_cast<std::uint32_t>(row.ray), row.level,
                  static_cast<std::size_t>(row.record)};
    RC_ASSERT(key == cell->first);
    RC_ASSERT(row.counts.references == cell->second[0]);
    RC_ASSERT(row.counts.misses == cell->second[1]);
    RC_ASSERT(row.counts.second_level_hits == cell->second[2]);
    ++cell;
  }
  if (machine.l2.sharing == SecondLevel::private_caches) {
    for (std::size_t node = 0; node < expected.second_misses.size(); ++node) {
      RC_ASSERT(result.l2.caches[node].misses == expected.second_misses[node]);
    }
  }
}

RC_GTEST_PROP(CacheCount, NodesThatCountAreNodesThatDoNot, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 9, 9);
  MachineConfig machine = test::random_machine(random);
  test::add_random_second_level(random, machine);
  const MachineResult fast = replay(log, machine, {.keep_read_events = true});
  machine.count = everything;
  machine.count.miss_classes = machine.cache.organisation != CacheOrganisation::none;
  for (const bool step_by_step : {false, true}) {
    const MachineResult counted = replay(log, machine, {.step_by_step = step_by_step});
    RC_ASSERT(counted.end == fast.end);
    for (std::size_t node = 0; node < fast.nodes.size(); ++node) {
      RC_ASSERT(counted.nodes[node].time == fast.nodes[node].time);
      RC_ASSERT(counted.nodes[node].references.hits == fast.nodes[node].references.hits);
      RC_ASSERT(counted.nodes[node].references.misses == fast.nodes[node].references.misses);
    }
    RC_ASSERT(step_by_step || counted.events == fast.events);
  }
}

RC_GTEST_PROP(CacheCount, AnIdealInterconnectMakesEveryMissWaitTheSame, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 6, 6);
  MachineConfig machine = random_counting_machine(random);
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.placement = Placement::shared;
  machine.l2.sharing = machine.l2.sharing == SecondLevel::shared ? SecondLevel::none : machine.l2.sharing;
  const MachineResult result = replay(log, machine);
  for (const AttributionRow& row : *result.counts.attribution) {
    RC_ASSERT(row.counts.transfer ==
              (row.counts.misses - row.counts.second_level_hits) * result.unloaded_miss);
    RC_ASSERT(row.counts.waited() == row.counts.transfer);
  }
}

std::int64_t misses_of_class(const MachineResult& result, memory::MissClass what) {
  std::int64_t sum = 0;
  for (const auto& kind : *result.counts.miss_classes) {
    sum += kind[static_cast<std::size_t>(what)];
  }
  return sum;
}

TEST(CacheCount, ClassesOfCachesThatCannotHaveThem) {
  test::Random random(5);
  const WorkLog log = test::random_log(random, 16, 16);
  for (int round = 0; round < 40; ++round) {
    MachineConfig machine = random_counting_machine(random);
    machine.cache.cache.ways = memory::full_ways;
    machine.cache.cache.replacement = memory::Replacement::lru;
    MachineResult result = replay(log, machine);
    EXPECT_EQ(misses_of_class(result, memory::MissClass::conflict), 0);
    machine.cache.cache.size = 1U << 20U;
    machine.cache.split_sizes.fill(1U << 20U);
    result = replay(log, machine);
    EXPECT_EQ(misses_of_class(result, memory::MissClass::compulsory), result.references().all_misses());
  }
}

TEST(SecondLevel, OneNodeIsComputePlusHitsOfBothLevelsPlusMissesTimesLatency) {
  test::Random random(6);
  for (int round = 0; round < 60; ++round) {
    const WorkLog log = test::random_log(random, 12, 12);
    MachineConfig machine = random_counting_machine(random);
    machine.count = {};
    machine.clusters = 1;
    machine.nodes = 1;
    machine.placement = Placement::shared;
    machine.interconnect.kind = memory::InterconnectKind::ideal;
    machine.layout.pixel_bytes = 1;
    machine.write_buffer = 4096;
    machine.l2.sharing = SecondLevel::none;
    const MachineResult without = replay(log, machine);
    machine.l2.sharing = SecondLevel::private_caches;
    const MachineResult with = replay(log, machine);
    const sim::Ticks saved =
        with.l2.counters().hits * (with.unloaded_miss - machine.clock.cycles(machine.l2.hit_cycles));
    EXPECT_EQ(with.nodes[0].finish, without.nodes[0].finish - saved);
  }
}

TEST(SecondLevel, ASharedOneThatHoldsEverythingReadsEachLineOfAClusterOnce) {
  test::Random random(7);
  const WorkLog log = test::random_log(random, 12, 12);
  for (int round = 0; round < 60; ++round) {
    MachineConfig machine = random_counting_machine(random);
    machine.placement = Placement::shared;
    machine.interconnect.kind = static_cast<memory::InterconnectKind>(1 + round % 2);
    machine.l2.sharing = SecondLevel::shared;
    machine.l2.cache = {.size = 1U << 22U, .ways = memory::full_ways};
    const MachineResult result = replay(log, machine);
    EXPECT_EQ(result.l2.counters().misses, result.counts.sharing->distinct);
    EXPECT_EQ(result.l2.counters().references(), result.references().all_misses());
  }
}

TEST(SecondLevel, RefusesWhatHasNoPlaceForIt) {
  test::Random random(8);
  const WorkLog log = test::random_log(random, 4, 4);
  MachineConfig machine;
  machine.l2.sharing = SecondLevel::private_caches;
  machine.cache.organisation = CacheOrganisation::none;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
  machine = {};
  machine.l2.sharing = SecondLevel::shared;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
  machine = {};
  machine.l2.sharing = SecondLevel::shared;
  machine.placement = Placement::replicated;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
  machine = {};
  machine.l2.sharing = SecondLevel::private_caches;
  machine.l2.cache.size = 100;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
}

TEST(CacheCount, RefusesWhatItCannotCount) {
  test::Random random(9);
  const WorkLog log = test::random_tree_log(random, 4, 4);
  MachineConfig machine;
  machine.count.miss_classes = true;
  machine.cache.organisation = CacheOrganisation::none;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
  machine = {};
  machine.count.sharing = true;
  machine.build.sharing = Sharing::shared;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
  machine = {};
  machine.count.miss_classes = true;
  machine.nodes = 1U << 20U;
  EXPECT_THROW((void)replay(log, machine), sim::UserError);
}

}  // namespace
}  // namespace marti::processors
