// Second-level caches, classes of misses, sharing and attribution against counts made from the log's
// references one by one, and nodes that count against nodes that do not.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "memory/cache.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "tests/support/naive_caches.h"
#include "tests/support/naive_counts.h"
#include "tests/support/random_machine.h"
#include "tests/support/told_caches.h"
#include "tests/support/traced_lines.h"

namespace marti::processors {

using namespace machine;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

// Tells `counts` of the references of nodes that always get the same packets; returns the misses of each
// node's second level.
std::vector<std::int64_t> refer_one_by_one(const WorkLog& log, const MachineConfig& machine,
                                           test::NaiveCounts& counts) {
  std::vector<std::int64_t> second_misses;
  const memory::Address line_bytes = machine.cache.cache.line;
  for (std::uint32_t node = 0; node < machine.all_nodes(); ++node) {
    test::NaiveCaches caches(machine);
    memory::CacheConfig second = machine.l2.cache;
    second.line = machine.cache.cache.line;
    memory::Cache behind(second);
    for (const test::TracedLine& reference : test::trace_node(log, machine, node)) {
      const bool hit = caches.refer(reference.kind, reference.line * line_bytes);
      test::NaiveAction action;
      action.kind = reference.kind;
      action.ray = reference.ray;
      action.level = reference.level;
      counts.refer(node, caches.number_of(reference.kind), action, reference.line, hit);
      if (!hit && machine.l2.sharing == SecondLevel::private_caches &&
          behind.read(reference.line * line_bytes, 1) == 0) {
        counts.second_level_hit(action);
      }
    }
    second_misses.push_back(behind.counters().misses);
  }
  return second_misses;
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
  const MachineResult result = replay::replay(log, machine);
  test::NaiveCounts counts(machine);
  const std::vector<std::int64_t> second_misses = refer_one_by_one(log, machine, counts);
  counts.expect(result.counts, false);
  RC_ASSERT(!::testing::Test::HasFailure());
  if (machine.l2.sharing == SecondLevel::private_caches) {
    for (std::size_t node = 0; node < second_misses.size(); ++node) {
      RC_ASSERT(result.l2.caches[node].misses == second_misses[node]);
    }
  }
}

RC_GTEST_PROP(CacheCount, NodesThatCountAreNodesThatDoNot, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 9, 9);
  MachineConfig machine = test::random_machine(random);
  test::add_random_second_level(random, machine);
  const MachineResult fast = replay::replay(log, machine, {.keep_read_events = true});
  machine.count = everything;
  machine.count.miss_classes = machine.cache.organisation != CacheOrganisation::none;
  for (const bool step_by_step : {false, true}) {
    const MachineResult counted = replay::replay(log, machine, {.step_by_step = step_by_step});
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
  const MachineResult result = replay::replay(log, machine);
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

TEST(SecondLevel, ASharedOneThatHoldsEverythingReadsEachLineOfAClusterOnce) {
  test::Random random(7);
  const WorkLog log = test::random_log(random, 12, 12);
  for (int round = 0; round < 60; ++round) {
    MachineConfig machine = random_counting_machine(random);
    machine.placement = Placement::shared;
    machine.interconnect.kind = static_cast<memory::InterconnectKind>(1 + round % 2);
    machine.l2.sharing = SecondLevel::shared;
    machine.l2.cache = {.size = 1U << 22U, .ways = memory::full_ways};
    const MachineResult result = replay::replay(log, machine);
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
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.l2.sharing = SecondLevel::shared;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.l2.sharing = SecondLevel::shared;
  machine.placement = Placement::replicated;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.l2.sharing = SecondLevel::private_caches;
  machine.l2.cache.size = 100;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
}

// The references of each row for which `of` is true, without its times.
template <class Of>
std::map<std::array<std::uint32_t, 4>, std::int64_t> references_of(const MachineResult& result,
                                                                   const Of& of) {
  std::map<std::array<std::uint32_t, 4>, std::int64_t> references;
  for (const AttributionRow& row : *result.counts.attribution) {
    if (of(row) && row.counts.references != 0) {
      references[{static_cast<std::uint32_t>(row.record), row.level, static_cast<std::uint32_t>(row.ray),
                  row.bounce}] = row.counts.references;
    }
  }
  return references;
}

// A tree that is built before the frame is read by rays as a given one is, and what builders read is apart.
RC_GTEST_PROP(CacheCount, ReadingForATreeIsApartFromReadingForRays, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_tree_log(random, 6, 6);
  MachineConfig machine = random_counting_machine(random);
  const auto given =
      references_of(replay::replay(log, machine), [](const AttributionRow& row) { return !row.splitting; });
  machine.build.sharing = Sharing::none;
  const MachineResult built = replay::replay(log, machine);
  RC_ASSERT(references_of(built, [](const AttributionRow& row) { return !row.splitting; }) == given);
  std::int64_t splitting = 0;
  for (const auto& [key, count] :
       references_of(built, [](const AttributionRow& row) { return row.splitting; })) {
    splitting += count;
  }
  std::int64_t all = splitting;
  for (const auto& [key, count] : given) {
    all += count;
  }
  RC_ASSERT(all == built.references().references());
  RC_ASSERT((splitting > 0) == (built.build.counts().start_up_splits > 0));
}

// A tree that nodes share while they build it: of the classes that a given tree has none of, there are some.
TEST(CacheCount, WritesOfATreeCauseMisses) {
  test::Random random(3);
  std::int64_t invalidation = 0;
  for (int round = 0; round < 40; ++round) {
    const WorkLog log = test::random_tree_log(random, 8, 8);
    MachineConfig machine = random_counting_machine(random);
    machine.clusters = 1;
    machine.nodes = 4;
    machine.build.sharing = Sharing::shared;
    machine.build.initial = InitialTree::level;
    test::share_in_order(machine);
    const MachineResult result = replay::replay(log, machine);
    invalidation += misses_of_class(result, memory::MissClass::invalidation);
    EXPECT_LE(misses_of_class(result, memory::MissClass::invalidation), result.build.counts().invalidations);
  }
  EXPECT_GT(invalidation, 100);
}

RC_GTEST_PROP(CacheCount, BuildersCountWhatTheirReferencesOneByOneDo, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_tree_log(random, 6, 6);
  MachineConfig machine = random_counting_machine(random);
  test::add_random_build(random, machine);
  if (random() % 2 == 0) {
    test::add_random_contexts(random, log.traversal < accel::Traversal::grid, machine);
  }
  const MachineResult result = replay::replay(log, machine);
  test::NaiveCounts counts(machine);
  test::tell_of_building(log, machine, counts);
  counts.expect(result.counts, true);
  RC_ASSERT(!::testing::Test::HasFailure());
}

// Running ahead would change a class in about one of a hundred such machines, so these are many and alike.
TEST(CacheCount, ClassesOfBuildersDoNotDependOnRunningAhead) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    test::Random random(seed);
    const WorkLog log = test::random_tree_log(random, 12, 12);
    MachineConfig machine;
    machine.nodes = 4;
    machine.build.sharing = Sharing::shared;
    machine.build.initial = InitialTree::level;
    machine.build.level = 1;
    machine.cache.cache = {.size = 512, .line = 16, .ways = 4, .replacement = memory::Replacement::fifo};
    machine.layout.node_bytes = 8;
    machine.packets = {2, 2, PacketOrder::scanline};
    machine.count.miss_classes = true;
    EXPECT_EQ(replay::replay(log, machine).counts.miss_classes,
              replay::replay(log, machine, {.step_by_step = true}).counts.miss_classes)
        << seed;
  }
}

TEST(CacheCount, RefusesWhatItCannotCount) {
  test::Random random(9);
  const WorkLog log = test::random_tree_log(random, 4, 4);
  MachineConfig machine;
  machine.count.miss_classes = true;
  machine.cache.organisation = CacheOrganisation::none;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.count.miss_classes = true;
  machine.nodes = 1U << 20U;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
}

}  // namespace
}  // namespace marti::processors
