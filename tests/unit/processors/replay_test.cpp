// The replay against closed forms, conservation laws and a second way of running it.
#include "processors/replay/replay.h"
#include "processors/replay/host_bytes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "accel/structure.h"
#include "processors/cost/step_time.h"
#include "processors/program/render.h"
#include "processors/walk/kept_visits.h"
#include "processors/walk/observer.h"
#include "processors/walk/stripped_log.h"
#include "scenes/procedural.h"
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

// Without a structure a ray refers to all triangles, which takes one word of the log.
TEST(Replay, AStrippedLogOfFarMoreWordsThanItsLogIsGivenUp) {
  for (const auto& [structure, given_up] : {std::pair("octree", false), std::pair("none", true)}) {
    const scenes::Scene scene = scenes::make_procedural("teapot:16");
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const Frame frame = render(scene, *triangles, *accel::make_structure(structure, triangles),
                               {.width = 12, .height = 12, .record = true});
    EXPECT_EQ(StrippedLog::make(*frame.log, MachineConfig()) == nullptr, given_up) << structure;
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
  sim::Ticks sum = ticks.branch * n(totals.branches) + ticks.transform * n(totals.transforms) +
                   ticks.leaf * n(totals.leaves) + ticks.lookup * n(totals.lookups) + ticks.test * tests[0] +
                   ticks.sphere_test * tests[1] + ticks.cone_test * tests[2] +
                   ticks.shade * n(totals.shades) + ticks.light * n(totals.lights) +
                   ticks.texel * n(totals.texels) + ticks.any_hit * n(totals.any_hits) +
                   ticks.cut * n(totals.cuts) + ticks.pass * n(totals.passes) +
                   ticks.pixel * std::int64_t{log.width} * log.height;
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    sum += ticks.ray[kind] * n(totals.rays[kind]);
  }
  return sum;
}

// No read may wait for the node's own writes: nothing waits on an ideal interconnect, and the only write of
// an image of one pixel comes last.
TEST(Replay, OneNodeIsComputePlusHitsPlusMissesTimesLatency) {
  test::Random random(11);
  for (int round = 0; round < 160; ++round) {
    const bool ideal = round < 60;
    const WorkLog log =
        ideal ? test::random_log(random, 16, 16, 40, true) : test::random_log(random, 1, 1, 2000, true);
    MachineConfig machine = test::random_machine(random);
    machine.clusters = 1;
    machine.nodes = 1;
    machine.placement = Placement::shared;
    machine.cache.organisation = round % 2 == 0 ? CacheOrganisation::unified : CacheOrganisation::split;
    machine.host.latency_cycles = 0;
    machine.host.occupancy_cycles = 0;
    // A bank must be free again before the next read can reach it.
    machine.banks.busy_cycles = machine.banks.access_cycles;
    if (ideal) {
      machine.layout.pixel_bytes = 1;
      machine.interconnect.kind = memory::InterconnectKind::ideal;
      machine.write_buffer = 4096;
    }
    const MachineResult result = replay::replay(log, machine);
    const ReferenceCounts references = result.references();
    EXPECT_EQ(result.nodes[0].finish,
              compute_of(log, machine) +
                  references.all_hits() * machine.clock.cycles(machine.cache.hit_cycles) +
                  references.all_misses() * result.unloaded_miss);
  }
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
    EXPECT_LT(host_bytes(machine, log.width, log.height), std::uint64_t{1} << 30U);
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

}  // namespace
}  // namespace marti::processors
