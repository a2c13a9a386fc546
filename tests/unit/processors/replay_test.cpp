// The replay against closed forms, conservation laws and a second way of running it.
#include "processors/replay/replay.h"
#include "processors/replay/host_bytes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/walk/kept_visits.h"
#include "processors/walk/observer.h"
#include "processors/walk/stripped_log.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/logged_samples.h"
#include "tests/support/random_machine.h"
#include "tests/support/traced_lines.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

// Another machine that may share the pass that strips `machine`'s log: with other ways, clocks and memories.
MachineConfig of_equal_key(test::Random& random, const MachineConfig& machine) {
  MachineConfig other = test::random_machine(random);
  other.layout = machine.layout;
  other.operations = machine.operations;
  other.word_bytes = machine.word_bytes;
  other.packets.width = machine.packets.width;
  other.packets.height = machine.packets.height;
  other.cache = machine.cache;
  other.banks.interleave = machine.banks.interleave;
  other.distribution.interleave = std::max(other.distribution.interleave, other.reference_bytes());
  if (machine.cache.organisation == CacheOrganisation::unified) {
    const std::uint32_t sets = memory::shape_of(machine.cache.cache).sets;
    other.cache.cache.ways = static_cast<std::uint32_t>(test::pick(random, 1, 9));
    other.cache.cache.size = std::uint64_t{sets} * other.cache.cache.ways * other.cache.cache.line;
    other.cache.cache.replacement =
        test::pick(random, 0, 3) == 0 ? memory::Replacement::fifo : memory::Replacement::lru;
  }
  return other;
}

RC_GTEST_PROP(Replay, AStrippedLogGivesTheSameResult, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  MachineConfig machine = test::random_machine(random);
  test::add_random_second_level(random, machine);
  const MachineConfig other = of_equal_key(random, machine);
  const std::array ways = {StrippedLog::ways_of(machine), StrippedLog::ways_of(other)};
  const auto both = StrippedLog::make(log, machine, ways);
  RC_ASSERT((both[0] == nullptr) == StrippedLog::key_of(machine).empty());
  RC_CLASSIFY(both[0] != nullptr);
  RC_CLASSIFY(both[0] != nullptr && ways[0] != 0, "LRU");
  if (both[0] == nullptr) {
    return;
  }
  test::expect_equal(replay::replay(log, machine), replay::replay(log, machine, {.stripped = both[0].get()}));
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  // Made alone it is the same log.
  RC_ASSERT(StrippedLog::make(log, machine)->bytes_of_words() == both[0]->bytes_of_words());
  if (StrippedLog::key_of(other) == both[1]->key()) {
    test::expect_equal(replay::replay(log, other), replay::replay(log, other, {.stripped = both[1].get()}));
    RC_ASSERT(!::testing::Test::HasFatalFailure());
  }
}

// Machines one after the other, some of which need the visits of the one before and some others.
RC_GTEST_PROP(Replay, KeptVisitsGiveTheSameResult, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  KeptVisits visits;
  MachineConfig machine = test::random_machine(random);
  for (int i = 0; i < 4; ++i) {
    test::expect_equal(replay::replay(log, machine), replay::replay(log, machine, {.visits = &visits}));
    RC_ASSERT(!::testing::Test::HasFatalFailure());
    machine = test::pick(random, 0, 2) == 0 ? test::random_machine(random) : of_equal_key(random, machine);
  }
}

// Everything that an observer is told.
class Told : public Observer {
 public:
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override {
    told.push_back({0, node, static_cast<std::int64_t>(state), from, to, pixel.x, pixel.y});
  }
  void missed(std::uint32_t node, std::int64_t misses, PixelPlace pixel) override {
    told.push_back({1, node, misses, 0, 0, pixel.x, pixel.y});
  }
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override {
    told.push_back({2, node, static_cast<std::int64_t>(packet), start, 0, 0, 0});
  }
  std::vector<std::array<std::int64_t, 7>> told;
};

RC_GTEST_PROP(Replay, ObserversAreToldAsMuchOfAStrippedLog, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  MachineConfig machine = test::random_machine(random);
  machine.build.sharing = Sharing::given;
  machine.contexts = 1;
  machine.prefetch = {};
  machine.count = {};
  const auto stripped = StrippedLog::make(log, machine);
  if (stripped == nullptr) {
    return;
  }
  Told whole;
  Told less;
  (void)replay::replay(log, machine, {.observer = &whole});
  (void)replay::replay(log, machine, {.observer = &less, .stripped = stripped.get()});
  RC_ASSERT(!whole.told.empty());
  RC_ASSERT(whole.told == less.told);
}

// Compute time of the whole log, from the counts of the log itself.
sim::Ticks compute_of(const WorkLog& log, const MachineConfig& machine) {
  const StepTicks ticks = step_ticks(machine, log);
  const LogTotals totals = totals_of(log);
  const std::array<std::int64_t, 3> tests = test::tests_by_kind(log);
  const auto n = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
  sim::Ticks sum = ticks.branch * n(totals.branches) + ticks.leaf * n(totals.leaves) +
                   ticks.lookup * n(totals.lookups) + ticks.test * tests[0] + ticks.sphere_test * tests[1] +
                   ticks.cone_test * tests[2] + ticks.shade * n(totals.shades) +
                   ticks.light * n(totals.lights) + ticks.texel * n(totals.texels) +
                   ticks.cut * n(totals.cuts) + ticks.pass * n(totals.passes) +
                   ticks.pixel * std::int64_t{log.width} * log.height;
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    sum += ticks.ray[kind] * n(totals.rays[kind]);
  }
  return sum;
}

TEST(Replay, OneNodeIsComputePlusHitsPlusMissesTimesLatency) {
  test::Random random(11);
  for (int round = 0; round < 60; ++round) {
    const WorkLog log = test::random_log(random, 16, 16);
    MachineConfig machine = test::random_machine(random);
    machine.clusters = 1;
    machine.nodes = 1;
    machine.placement = Placement::shared;
    machine.cache.organisation = round % 2 == 0 ? CacheOrganisation::unified : CacheOrganisation::split;
    // No contention: reads must not wait for the node's own posted writes.
    machine.layout.pixel_bytes = 1;
    machine.interconnect.kind = memory::InterconnectKind::ideal;
    machine.write_buffer = 4096;
    machine.host.latency_cycles = 0;
    machine.host.occupancy_cycles = 0;
    const MachineResult result = replay::replay(log, machine);
    const ReferenceCounts references = result.references();
    const sim::Ticks expected = compute_of(log, machine) +
                                references.all_hits() * machine.clock.cycles(machine.cache.hit_cycles) +
                                references.all_misses() * result.unloaded_miss;
    EXPECT_EQ(result.nodes[0].finish, expected);
  }
}

TEST(Replay, OneNodeOnABusWithSlowPixelsIsExactToo) {
  // One pixel, so the only write comes last and no read can wait for it.
  test::Random random(12);
  for (int round = 0; round < 100; ++round) {
    const WorkLog log = test::random_log(random, 1, 1, 2000);
    MachineConfig machine = test::random_machine(random);
    machine.clusters = 1;
    machine.nodes = 1;
    machine.placement = Placement::shared;
    machine.cache.organisation = CacheOrganisation::unified;
    machine.host.latency_cycles = 0;
    machine.host.occupancy_cycles = 0;
    // A bank must be free again before the next read can reach it.
    machine.banks.busy_cycles = machine.banks.access_cycles;
    const MachineResult result = replay::replay(log, machine);
    const ReferenceCounts references = result.references();
    EXPECT_EQ(result.nodes[0].finish,
              compute_of(log, machine) +
                  references.all_hits() * machine.clock.cycles(machine.cache.hit_cycles) +
                  references.all_misses() * result.unloaded_miss);
  }
}

TEST(Replay, ACacheLargerThanTheDatabaseMissesOncePerNodeAndDistinctLine) {
  test::Random random(14);
  const WorkLog log = test::random_log(random, 24, 24);
  MachineConfig machine;
  machine.nodes = 1;
  machine.cache.cache.size = 1 << 20;
  machine.cache.cache.ways = memory::full_ways;
  const MachineResult one = replay::replay(log, machine);
  std::set<std::uint32_t> lines;
  for (const test::TracedLine& traced : test::trace_node(log, machine, 0)) {
    lines.insert(traced.line);
  }
  EXPECT_EQ(one.references().all_misses(), static_cast<std::int64_t>(lines.size()));
  machine.nodes = 7;
  const MachineResult seven = replay::replay(log, machine);
  EXPECT_LE(seven.references().all_misses(), 7 * static_cast<std::int64_t>(lines.size()));
  EXPECT_GE(seven.references().all_misses(), static_cast<std::int64_t>(lines.size()));
}

TEST(Replay, RefusesWhatCannotBeBuiltOrTimed) {
  test::Random random(17);
  const WorkLog log = test::random_log(random, 4, 4);
  MachineConfig machine;
  machine.nodes = 0;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.clusters = 1U << 16U;
  machine.nodes = 1U << 16U;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.cache.cache.line = 1;
  machine.layout.section_alignment = 1U << 31U;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.clock = sim::Clock::from_period(std::int64_t{1} << 60U);
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  machine = {};
  machine.host.latency_cycles = std::int64_t{1} << 62U;
  EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
}

TEST(Replay, PixelWritesThatSwampACrossbarKeepTheLawsToo) {
  test::Random random(19);
  const WorkLog log = test::random_log(random, 12, 12, 4);
  MachineConfig machine;
  machine.placement = Placement::replicated;
  machine.interconnect.kind = memory::InterconnectKind::crossbar;
  machine.interconnect.cycles_per_beat = 100'000;
  machine.banks.count = 1;
  machine.banks.busy_cycles = 0;
  EXPECT_GT(replay::replay(log, machine).end, 0) << "replay checks its result itself";
}

TEST(Replay, OneNodeOfADistributedMachineHasAllInItsOwnMemory) {
  // One pixel, so the only write comes last; then its times are those of a replicated database.
  test::Random random(20);
  for (int round = 0; round < 60; ++round) {
    const WorkLog log = test::random_log(random, 1, 1, 500);
    MachineConfig machine = test::random_machine(random);
    machine.clusters = 1;
    machine.nodes = 1;
    machine.distribution.interleave = 1U << 12U;
    machine.placement = Placement::distributed;
    const MachineResult distributed = replay::replay(log, machine);
    machine.placement = Placement::replicated;
    const MachineResult replicated = replay::replay(log, machine);
    EXPECT_EQ(distributed.nodes[0].finish, replicated.nodes[0].finish);
    EXPECT_EQ(distributed.nodes[0].time[static_cast<std::size_t>(Activity::transfer)],
              replicated.nodes[0].time[static_cast<std::size_t>(Activity::transfer)]);
    EXPECT_EQ(distributed.clusters[0].distributed->network.messages, 0);
    EXPECT_EQ(distributed.references().misses, replicated.references().misses);
  }
}

TEST(Replay, ADistributedDatabaseIsReadWithoutWaitingWhereNobodyIsInTheWay) {
  // One node works, the others only hold the database: each miss costs the messages to its home.
  test::Random random(21);
  for (int round = 0; round < 30; ++round) {
    const WorkLog log = test::random_log(random, 1, 1, 500);
    MachineConfig machine;
    machine.nodes = 9;
    machine.placement = Placement::distributed;
    machine.network.kind = static_cast<memory::NetworkKind>(test::pick(random, 0, 4));
    const MachineResult result = replay::replay(log, machine);
    const TimeDivision time = result.time();
    EXPECT_EQ(time[static_cast<std::size_t>(Activity::interconnect_wait)], 0);
    EXPECT_EQ(time[static_cast<std::size_t>(Activity::bank_wait)], 0);
    const DistributedResult& distributed = *result.clusters[0].distributed;
    EXPECT_EQ(time[static_cast<std::size_t>(Activity::bank_access)],
              result.references().all_misses() * machine.local.clock.cycles(machine.local.access_cycles));
    EXPECT_EQ(distributed.accesses.local_reads + distributed.accesses.remote_reads,
              result.references().all_misses());
  }
}

TEST(Replay, SixtyFiveThousandNodesMayHoldADatabaseTogether) {
  test::Random random(22);
  const WorkLog log = test::random_log(random, 16, 16);
  for (const memory::NetworkKind kind : {memory::NetworkKind::mesh, memory::NetworkKind::hypercube}) {
    MachineConfig machine;
    machine.nodes = 65536;
    machine.packets = {1, 1, PacketOrder::scanline};
    machine.placement = Placement::distributed;
    machine.network.kind = kind;
    EXPECT_GT(replay::replay(log, machine).end, 0);
    EXPECT_LT(host_bytes(machine), std::uint64_t{1} << 30U);
  }
}

TEST(Replay, RefusesADistributedDatabaseThatCannotBeSpread) {
  test::Random random(23);
  const WorkLog log = test::random_log(random, 2, 2);
  for (const auto& spoil :
       {+[](MachineConfig& m) { m.distribution.interleave = 48; },
        +[](MachineConfig& m) { m.distribution.interleave = 16; },
        +[](MachineConfig& m) { m.distribution.header_bytes = 0; },
        +[](MachineConfig& m) { m.network.width = 0; }, +[](MachineConfig& m) { m.local.width = 0; },
        +[](MachineConfig& m) { m.scheme = Scheme::space; }}) {
    MachineConfig machine;
    machine.placement = Placement::distributed;
    spoil(machine);
    EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  }
}

TEST(Replay, ArbitrationChangesWhoWaitsNotWhatIsDone) {
  test::Random random(24);
  const WorkLog log = test::random_log(random, 24, 24);
  MachineConfig machine;
  machine.nodes = 12;
  machine.write_buffer = 1;
  machine.host.assignment = Assignment::interleaved;
  machine.packets = {2, 2, PacketOrder::scanline};
  machine.interconnect.cycles_per_beat = 20;
  const MachineResult fifo = replay::replay(log, machine);
  machine.interconnect.arbitration = memory::Arbitration::fixed_priority;
  const MachineResult fixed = replay::replay(log, machine);
  machine.interconnect.arbitration = memory::Arbitration::round_robin;
  const MachineResult turns = replay::replay(log, machine);
  for (const MachineResult* other : {&fixed, &turns}) {
    EXPECT_EQ(other->references().misses, fifo.references().misses);
    EXPECT_EQ(other->clusters[0].interconnect.busy, fifo.clusters[0].interconnect.busy);
    EXPECT_EQ(other->clusters[0].interconnect.bytes, fifo.clusters[0].interconnect.bytes);
  }
  const auto spread = [](const MachineResult& result) {
    const auto [first, last] =
        std::minmax_element(result.nodes.begin(), result.nodes.end(),
                            [](const auto& a, const auto& b) { return a.finish < b.finish; });
    return static_cast<double>(last->finish - first->finish) / static_cast<double>(result.end);
  };
  EXPECT_GT(spread(fixed), 2 * spread(turns)) << "low nodes finish early, the high ones starve";
  EXPECT_GT(turns.time()[static_cast<std::size_t>(Activity::queue_full_wait)], 0);
}

}  // namespace
}  // namespace marti::processors
