// One pass over the references of a replay against machines with other caches.
#include "processors/passes/working_set.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "memory/cache.h"
#include "processors/replay/replay.h"
#include "processors/walk/node_caches.h"
#include "sim/error.h"
#include "tests/support/heard_references.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace machine;
using namespace passes;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

MachineConfig random_cached_machine(test::Random& random) {
  MachineConfig machine = test::random_machine(random);
  if (machine.cache.organisation == CacheOrganisation::none) {
    machine.cache.organisation = CacheOrganisation::unified;
    machine.distribution.interleave = std::max(machine.distribution.interleave, machine.cache.cache.line);
  }
  test::add_random_second_level(random, machine);
  machine.count.working_set = true;
  check_working_set(machine);
  return machine;
}

// A node's lines that go to one of its caches, by a walk that stops at each reference.
std::vector<memory::Address> lines_of(const test::HeardReferences& trace, std::uint32_t node,
                                      const NodeCacheConfig& config, std::size_t cache) {
  std::vector<memory::Address> lines;
  trace.for_each(node, [&](const test::HeardReference& reference) {
    if (!reference.write && (config.organisation == CacheOrganisation::unified ||
                             split_cache_of[static_cast<std::size_t>(reference.kind)] == cache)) {
      lines.push_back(reference.address / config.cache.line);
    }
  });
  return lines;
}

RC_GTEST_PROP(WorkingSet, IsThatOfCachesSimulatedOneByOne, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  const MachineConfig machine = random_cached_machine(random);
  test::HeardReferences trace;
  const MachineResult result = replay::replay(log, machine, {.observer = &trace});
  const WorkingSet set = working_set(trace);
  check_working_set(set, machine, result);
  RC_ASSERT(set.line == machine.cache.cache.line);
  RC_ASSERT(set.caches.size() == (machine.cache.organisation == CacheOrganisation::split ? split_caches : 1));
  for (std::size_t i = 0; i < set.caches.size(); ++i) {
    const CacheWorkingSet& found = set.caches[i];
    const auto misses = [&](std::uint32_t sets, std::uint32_t ways) {
      std::int64_t sum = 0;
      for (std::uint32_t node = 0; node < trace.nodes(); ++node) {
        memory::Cache cache({.size = std::uint64_t{sets} * ways * 4, .line = 4, .ways = ways});
        for (const memory::Address line : lines_of(trace, node, machine.cache, i)) {
          (void)cache.read(line * 4, 1);
        }
        sum += cache.counters().misses;
      }
      return sum;
    };
    for (const std::uint32_t lines : {1U, 2U, 3U, 7U, 16U, 17U, 40U, 300U}) {
      RC_ASSERT(found.distances.misses(lines) == misses(1, lines));
    }
    RC_ASSERT(found.ways.sets == (found.shape.sets > 1 ? found.shape.sets : 0));
    if (found.shape.sets > 1) {
      for (const std::uint32_t ways : {1U, 2U, 5U, counted_ways, found.shape.ways}) {
        RC_ASSERT(found.ways.misses(ways) == misses(found.shape.sets, ways));
      }
    }
  }
}

RC_GTEST_PROP(WorkingSet, IsTheSameWithAnyNumberOfThreads, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 10, 10);
  PacketsOfNodes packets_of_nodes;
  (void)replay::replay(log, random_cached_machine(random), {.observer = &packets_of_nodes});
  const WorkingSet one = working_set(packets_of_nodes, 1);
  const WorkingSet three = working_set(packets_of_nodes, 3);
  for (std::size_t i = 0; i < one.caches.size(); ++i) {
    RC_ASSERT(one.caches[i].distances == three.caches[i].distances);
    RC_ASSERT(one.caches[i].ways == three.caches[i].ways);
  }
}

RC_GTEST_PROP(WorkingSet, ForetellsMachinesWithOtherCachesWherePacketsAreFixed, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 10, 10);
  MachineConfig machine = random_cached_machine(random);
  machine.cache.organisation = CacheOrganisation::unified;
  machine.host.assignment = Assignment::interleaved;
  PacketsOfNodes packets_of_nodes;
  (void)replay::replay(log, machine, {.observer = &packets_of_nodes});
  const WorkingSet set = working_set(packets_of_nodes);
  RC_ASSERT(set.any_cache);
  machine.cache.cache.replacement = memory::Replacement::lru;
  const auto lines = static_cast<std::uint32_t>(test::pick(random, 1, 60));
  machine.cache.cache.size = std::uint64_t{lines} * machine.cache.cache.line;
  machine.cache.cache.ways = memory::full_ways;
  RC_ASSERT(replay::replay(log, machine).references().all_misses() == set.caches[0].distances.misses(lines));
  if (const std::uint32_t sets = set.caches[0].ways.sets; sets > 1) {
    machine.cache.cache.ways = static_cast<std::uint32_t>(test::pick(random, 1, counted_ways));
    machine.cache.cache.size = std::uint64_t{sets} * machine.cache.cache.ways * machine.cache.cache.line;
    RC_ASSERT(replay::replay(log, machine).references().all_misses() ==
              set.caches[0].ways.misses(machine.cache.cache.ways));
  }
}

TEST(WorkingSet, SaysForWhichPacketsItHolds) {
  test::Random random(3);
  const WorkLog log = test::random_log(random, 6, 6);
  const auto holds_for_any_cache = [&](std::uint32_t nodes, Assignment assignment) {
    MachineConfig machine;
    machine.nodes = nodes;
    machine.host.assignment = assignment;
    PacketsOfNodes packets_of_nodes;
    (void)replay::replay(log, machine, {.observer = &packets_of_nodes});
    return working_set(packets_of_nodes).any_cache;
  };
  EXPECT_TRUE(holds_for_any_cache(1, Assignment::dynamic));
  EXPECT_TRUE(holds_for_any_cache(2, Assignment::interleaved));
  EXPECT_TRUE(holds_for_any_cache(2, Assignment::blocks));
  EXPECT_FALSE(holds_for_any_cache(2, Assignment::dynamic));
}

TEST(WorkingSet, ACountThatDiffersIsAFaultOfOurs) {
  test::Random random(4);
  const WorkLog log = test::random_log(random, 6, 6);
  const MachineConfig machine;
  PacketsOfNodes packets_of_nodes;
  MachineResult result = replay::replay(log, machine, {.observer = &packets_of_nodes});
  const WorkingSet set = working_set(packets_of_nodes);
  EXPECT_NO_THROW(check_working_set(set, machine, result));
  --result.nodes[1].references.hits[0];
  EXPECT_THROW(check_working_set(set, machine, result), sim::InternalError);
  ++result.nodes[1].references.misses[0];
  EXPECT_THROW(check_working_set(set, machine, result), sim::InternalError);
}

TEST(WorkingSet, RefusesMachinesOfWhichItCannotBeTold) {
  const auto refused = [](const auto& change) {
    MachineConfig machine;
    machine.count.working_set = true;
    EXPECT_NO_THROW(check_working_set(machine));
    change(machine);
    EXPECT_THROW(check_working_set(machine), sim::UserError);
    machine.count.working_set = false;
    EXPECT_NO_THROW(check_working_set(machine));
  };
  refused([](MachineConfig& machine) { machine.scheme = Scheme::pipeline; });
  refused([](MachineConfig& machine) { machine.cache.organisation = CacheOrganisation::none; });
  refused([](MachineConfig& machine) { machine.build.sharing = Sharing::shared; });
  refused([](MachineConfig& machine) { machine.contexts = 2; });
  refused([](MachineConfig& machine) { machine.prefetch.next_line = true; });
  refused([](MachineConfig& machine) {
    machine.cache.cache.ways = 8192;
    machine.cache.cache.size = std::uint64_t{2} * 8192 * 32;
  });
  refused([](MachineConfig& machine) {  // 2^25 lines are simulated, but not sixteen ways of so many sets
    machine.cache.cache.ways = 1;
    machine.cache.cache.size = std::uint64_t{1} << 30U;
  });
}

}  // namespace
}  // namespace marti::processors
