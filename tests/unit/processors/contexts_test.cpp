// Nodes with contexts and prefetching: against nodes without, against a plain second implementation, against
// closed forms, and against themselves with an event for every reference.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <set>
#include <utility>

#include "processors/replay/replay.h"
#include "processors/walk/observer.h"
#include "sim/error.h"
#include "tests/support/random_machine.h"
#include "tests/unit/processors/naive_contexts.h"

namespace marti::processors {
namespace {

void expect_equal(const MachineResult& a, const MachineResult& b) {
  ASSERT_EQ(a.end, b.end);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    ASSERT_EQ(a.nodes[n].references.hits, b.nodes[n].references.hits) << "node " << n;
    ASSERT_EQ(a.nodes[n].references.misses, b.nodes[n].references.misses) << "node " << n;
    for (std::size_t i = 0; i < activities; ++i) {
      ASSERT_EQ(a.nodes[n].time[i], b.nodes[n].time[i]) << "node " << n << ", " << activity_names[i];
    }
    ASSERT_EQ(a.nodes[n].finish, b.nodes[n].finish);
    ASSERT_EQ(a.nodes[n].packets, b.nodes[n].packets);
    ASSERT_EQ(a.nodes[n].writes, b.nodes[n].writes);
  }
  ASSERT_EQ(a.contexts.nodes.size(), b.contexts.nodes.size());
  for (std::size_t n = 0; n < a.contexts.nodes.size(); ++n) {
    for (const auto& counter : ContextCounts::counters()) {
      ASSERT_EQ(a.contexts.nodes[n].*counter.member, b.contexts.nodes[n].*counter.member)
          << "node " << n << ", " << counter.name;
    }
  }
  ASSERT_EQ(a.clusters.size(), b.clusters.size());
  for (std::size_t c = 0; c < a.clusters.size(); ++c) {
    const memory::InterconnectStatistics& x = a.clusters[c].interconnect;
    const memory::InterconnectStatistics& y = b.clusters[c].interconnect;
    ASSERT_EQ(x.reads, y.reads);
    ASSERT_EQ(x.busy, y.busy);
    ASSERT_EQ(x.waits.sum, y.waits.sum);
    ASSERT_EQ(x.waits.max, y.waits.max);
    for (std::size_t i = 0; i < a.clusters[c].banks.size(); ++i) {
      ASSERT_EQ(a.clusters[c].banks[i].waits.sum, b.clusters[c].banks[i].waits.sum);
      ASSERT_EQ(a.clusters[c].banks[i].accesses, b.clusters[c].banks[i].accesses);
    }
  }
}

void add_contexts(test::Random& random, bool tree, MachineConfig& machine) {
  if (machine.placement == Placement::distributed) {
    machine.placement = Placement::shared;
  }
  test::add_random_second_level(random, machine);
  if (machine.l2.sharing == SecondLevel::private_caches) {
    machine.l2.sharing = SecondLevel::none;
  }
  machine.contexts = static_cast<std::uint32_t>(test::pick(random, 1, 5));
  machine.switch_cycles = test::pick(random, 0, 6);
  if (machine.placement == Placement::shared && machine.cache.organisation != CacheOrganisation::none) {
    machine.prefetch.next_line = random() % 2 == 0;
    machine.prefetch.children = tree && random() % 2 == 0;
    machine.prefetch.outstanding = static_cast<std::uint32_t>(test::pick(random, 1, 4));
  }
}

MachineConfig random_contexts(test::Random& random, const WorkLog& log, std::uint32_t most_nodes = 8) {
  MachineConfig machine = test::random_machine(random, most_nodes);
  add_contexts(random, log.traversal < accel::Traversal::grid, machine);
  return machine;
}

WorkLog small_log(test::Random& random) {
  return test::random_log(random, static_cast<std::uint32_t>(test::pick(random, 1, 10)),
                          static_cast<std::uint32_t>(test::pick(random, 1, 10)));
}

RC_GTEST_PROP(Contexts, OneContextGivesWhatNodesWithoutContextsGive, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = small_log(random);
  const MachineConfig machine = test::random_machine(random);
  MachineResult one = replay(log, machine, {.with_contexts = true});
  RC_ASSERT(one.contexts.counts().switches == 0);
  one.contexts.nodes.clear();
  expect_equal(replay(log, machine), one);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

RC_GTEST_PROP(Contexts, RunningAheadEqualsAnEventForEveryReference, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = small_log(random);
  const MachineConfig machine = random_contexts(random, log);
  const MachineResult ahead = replay(log, machine);
  const MachineResult stepped = replay(log, machine, {.step_by_step = true});
  expect_equal(ahead, stepped);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  RC_ASSERT(ahead.events <= stepped.events);
}

RC_GTEST_PROP(Contexts, ThePlainImplementationGivesTheSame, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = small_log(random);
  MachineConfig machine = random_contexts(random, log);
  if (machine.cache.cache.replacement != memory::Replacement::fifo) {
    machine.cache.cache.replacement = memory::Replacement::lru;
  }
  expect_equal(replay(log, machine, {.with_contexts = true}), test::NaiveContexts(log, machine).run());
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

RC_GTEST_PROP(Contexts, TheOrderOfTheFirstEventsDoesNotMatter, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 9, 7);
  const MachineConfig machine = random_contexts(random, log);
  expect_equal(replay(log, machine), replay(log, machine, {.start_seed = random() | 1U}));
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

RC_GTEST_PROP(Contexts, ScalingEveryDurationScalesEveryTimeExactly, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = small_log(random);
  const MachineConfig machine = random_contexts(random, log);
  const MachineResult base = replay(log, machine);
  MachineConfig slow = machine;
  for (sim::Clock* clock :
       {&slow.clock, &slow.interconnect.clock, &slow.banks.clock, &slow.host.clock, &slow.local.clock}) {
    *clock = sim::Clock::from_period(clock->period() * 1'000'000);
  }
  const MachineResult scaled = replay(log, slow);
  RC_ASSERT(scaled.end == base.end * 1'000'000);
  for (std::size_t n = 0; n < base.nodes.size(); ++n) {
    for (std::size_t i = 0; i < activities; ++i) {
      RC_ASSERT(scaled.nodes[n].time[i] == base.nodes[n].time[i] * 1'000'000);
    }
  }
}

/// Adds up the observed pieces, which must follow each other.
struct Watcher final : Observer {
  explicit Watcher(std::uint32_t nodes) : told(nodes), time(nodes), misses(nodes), packet(nodes) {}

  void begin(const ReplayInput& input) override { packets = &input.packets; }
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override {
    EXPECT_EQ(from, told[node]);
    EXPECT_LE(from, to);
    told[node] = to;
    time[node][static_cast<std::size_t>(state)] += to - from;
    if (!pixel.none() && state != NodeState::working) {
      const Packet at = (*packets)[packet[node]];
      EXPECT_TRUE(pixel.x >= at.x0 && pixel.x < at.x1 && pixel.y >= at.y0 && pixel.y < at.y1);
    }
  }
  void missed(std::uint32_t node, std::int64_t count, PixelPlace pixel) override {
    EXPECT_FALSE(pixel.none());
    misses[node] += count;
  }
  void began_packet(std::uint32_t node, std::uint64_t number, sim::Ticks start) override {
    EXPECT_EQ(start, told[node]);
    EXPECT_TRUE(begun.insert(number).second);
    packet[node] = number;
  }
  void resumed_packet(std::uint32_t node, std::uint64_t number) override { packet[node] = number; }
  void end(sim::Ticks at) override {
    EXPECT_EQ(std::set<sim::Ticks>(told.begin(), told.end()), std::set{at});
  }

  const PacketList* packets = nullptr;
  std::set<std::uint64_t> begun;
  std::vector<sim::Ticks> told;
  std::vector<std::array<sim::Ticks, node_states>> time;
  std::vector<std::int64_t> misses;
  std::vector<std::uint64_t> packet;
};

RC_GTEST_PROP(Contexts, WhoWatchesIsToldAllOfIt, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = small_log(random);
  const MachineConfig machine = random_contexts(random, log);
  Watcher watcher(machine.all_nodes());
  const MachineResult result = replay(log, machine, {.observer = &watcher, .with_contexts = true});
  expect_equal(result, replay(log, machine, {.with_contexts = true}));
  RC_ASSERT(watcher.begun.size() == result.packets);
  for (std::size_t n = 0; n < result.nodes.size(); ++n) {
    RC_ASSERT(watcher.misses[n] == result.nodes[n].references.all_misses());
    const TimeDivision& time = result.nodes[n].time;
    for (const auto& [state, activity] :
         {std::pair{NodeState::interconnect_wait, Activity::interconnect_wait},
          {NodeState::bank_wait, Activity::bank_wait},
          {NodeState::queue_full_wait, Activity::queue_full_wait},
          {NodeState::dispatch_wait, Activity::dispatch_wait},
          {NodeState::idle, Activity::idle}}) {
      RC_ASSERT(watcher.time[n][static_cast<std::size_t>(state)] == time[static_cast<std::size_t>(activity)]);
    }
  }
  RC_ASSERT(!::testing::Test::HasFailure());
}

// Checks that the properties above meet every kind of event that is counted.
TEST(Contexts, RandomMachinesDoAllThereIsToDo) {
  ContextCounts sum;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    test::Random random(seed);
    const WorkLog log = small_log(random);
    sim::merge(sum, replay(log, random_contexts(random, log)).contexts.counts());
  }
  sim::for_each_counter(sum, [](const sim::Counter<ContextCounts>& counter, std::int64_t value) {
    EXPECT_GT(value, 100) << counter.name;
  });
}

// A tree of one branch over eight empty leaves.
accel::Topology one_branch() {
  accel::Topology topology;
  topology.nodes.push_back({1, 8, 1, false});
  topology.nodes.insert(topology.nodes.end(), 8, accel::TopologyNode{0, 0, 2, true});
  return topology;
}

// One row of `pixels` pixels, each the same `steps` steps.
WorkLog row_of(std::uint32_t pixels, const std::vector<std::uint32_t>& words, accel::Topology topology) {
  WorkLog log;
  log.width = pixels;
  log.height = 1;
  log.topology = std::move(topology);
  log.texture_begin = {0};
  log.rows.resize(1);
  for (std::uint32_t x = 0; x < pixels; ++x) {
    log.rows[0].begin.push_back(static_cast<std::uint32_t>(log.rows[0].words.size()));
    log.rows[0].words.insert(log.rows[0].words.end(), words.begin(), words.end());
  }
  log.rows[0].begin.push_back(static_cast<std::uint32_t>(log.rows[0].words.size()));
  return log;
}

// The end of a frame of `contexts` pixels, each `misses` runs of `run` cycles that end in a miss.
sim::Ticks periodic_end(std::uint32_t contexts, std::uint32_t misses, std::int64_t run, std::int64_t latency,
                        std::int64_t switch_cycles) {
  const WorkLog log =
      row_of(contexts, std::vector<std::uint32_t>(misses, make_word(Step::branch, 0)), one_branch());
  MachineConfig machine;
  machine.nodes = 1;
  machine.clock = sim::Clock::from_period(1);
  machine.operations = {0, 0, 0, 0, 0, 0, run, 0};
  machine.layout.node_bytes = 4;  // one word, so a visit takes `run` cycles
  machine.cache.organisation = CacheOrganisation::none;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.clock = sim::Clock::from_period(1);
  machine.interconnect.latency_cycles = latency;
  machine.host.assignment = Assignment::interleaved;
  machine.packets = {1, 1, PacketOrder::scanline};
  machine.contexts = contexts;
  machine.switch_cycles = switch_cycles;
  return replay(log, machine).end;
}

// Saavedra-Barrera, Culler, von Eicken, Analysis of multithreaded architectures for parallel computing, SPAA
// 1990, section 3: with runs of R, latency L and switches of C, N contexts take R + C + L a round below
// saturation and N (R + C) from N = 1 + L / (R + C) on. One context never switches: R + L.
TEST(Contexts, PeriodicMissesTakeTheTimeOfTheClosedForm) {
  int saturated = 0;
  int linear = 0;
  for (const std::int64_t run : {1, 3, 10}) {
    for (const std::int64_t latency : {0, 1, 7, 20, 63}) {
      for (const std::int64_t cost : {0, 1, 4}) {
        for (std::uint32_t contexts = 1; contexts <= 12; ++contexts) {
          const std::uint32_t misses = 40;
          const sim::Ticks rounds = periodic_end(contexts, 2 * misses, run, latency, cost) -
                                    periodic_end(contexts, misses, run, latency, cost);
          const bool full = (contexts - 1) * (run + cost) >= latency;
          ++(full ? saturated : linear);
          std::int64_t round = full ? contexts * (run + cost) : run + cost + latency;
          if (contexts == 1) {
            round = run + latency;
          } else if (latency == 0) {
            // A miss that takes no time is no reason to switch: each packet is traced whole.
            round = contexts * run;
          }
          EXPECT_EQ(rounds, misses * round)
              << "R " << run << ", L " << latency << ", C " << cost << ", N " << contexts;
        }
      }
    }
  }
  EXPECT_GT(saturated, 100);
  EXPECT_GT(linear, 100);
}

TEST(Contexts, ARequestToTheHostIsWorkedThrough) {
  // Two contexts, no misses: while one waits 50 cycles for a packet the other computes 100.
  const WorkLog log = row_of(16, {make_word(Step::branch, 0)}, one_branch());
  MachineConfig machine;
  machine.nodes = 1;
  machine.clock = sim::Clock::from_period(1);
  machine.operations = {0, 0, 0, 0, 0, 0, 100, 0};
  machine.layout.node_bytes = 4;
  machine.placement = Placement::replicated;
  machine.local.access_cycles = 0;
  machine.local.cycles_per_beat = 0;
  machine.cache.hit_cycles = 0;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.latency_cycles = 0;
  machine.packets = {1, 1, PacketOrder::scanline};
  machine.host.clock = sim::Clock::from_period(1);
  machine.host.latency_cycles = 50;
  EXPECT_EQ(replay(log, machine).end, 16 * (100 + 50));
  machine.contexts = 2;
  machine.switch_cycles = 0;
  const MachineResult two = replay(log, machine);
  EXPECT_EQ(two.end, 50 + 16 * 100);
  EXPECT_EQ(two.host.requests, 18);
  machine.switch_cycles = 5;
  EXPECT_EQ(replay(log, machine).end, 50 + 16 * 100 + 15 * 5)
      << "each packet but the first is begun by another context";
}

// A log that reads `texels` texels one after the other.
WorkLog scan(std::uint32_t texels) {
  std::vector<std::uint32_t> words;
  for (std::uint32_t i = 0; i < texels; ++i) {
    words.insert(words.end(), {make_word(Step::texel, 0), i});
  }
  WorkLog log = row_of(1, words, one_branch());
  log.texture_begin = {0, texels};
  return log;
}

TEST(Prefetch, ASequentialScanMissesEveryOtherLine) {
  for (const std::uint32_t lines : {1U, 2U, 3U, 64U, 101U}) {
    MachineConfig machine;
    machine.nodes = 1;
    const WorkLog log = scan(lines * 8);  // 4 bytes each, lines of 32
    const MachineResult without = replay(log, machine);
    EXPECT_EQ(without.references().all_misses(), lines);
    machine.prefetch.next_line = true;
    const MachineResult with = replay(log, machine);
    EXPECT_EQ(with.references().all_misses(), (lines + 1) / 2);
    const ContextCounts counts = with.contexts.counts();
    EXPECT_EQ(counts.issued, lines / 2) << "the last line has no next one";
    EXPECT_EQ(counts.useful, lines / 2);
    EXPECT_EQ(counts.useless, 0);
    EXPECT_EQ(counts.dropped, 0);
    if (lines > 1) {
      EXPECT_LT(with.end, without.end);
    }
  }
}

TEST(Prefetch, LateIsWhatTheComputingInBetweenDoesNotCover) {
  // Two lines. The first line's data come at L; the second was asked for at the same time.
  const WorkLog log = scan(16);
  MachineConfig machine;
  machine.nodes = 1;
  machine.clock = sim::Clock::from_period(1);
  machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
  machine.cache.hit_cycles = 3;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.clock = sim::Clock::from_period(1);
  machine.interconnect.latency_cycles = 100;
  machine.host.assignment = Assignment::blocks;
  machine.prefetch.next_line = true;
  const MachineResult early = replay(log, machine);
  EXPECT_EQ(early.contexts.counts().late, 0) << "both lines come at 100";
  EXPECT_EQ(early.nodes[0].finish, 100 + 15 * 3);
  // With a bus the second line comes one transfer later, and there is nothing to do in between.
  machine.interconnect.kind = memory::InterconnectKind::bus;
  machine.interconnect.mode = memory::BusMode::split;
  machine.interconnect.address_cycles = 1;
  machine.interconnect.width = 32;
  machine.interconnect.cycles_per_beat = 40;
  machine.banks.clock = sim::Clock::from_period(1);
  machine.banks.access_cycles = 10;
  machine.banks.busy_cycles = 10;
  const MachineResult late = replay(log, machine);
  EXPECT_EQ(late.contexts.counts().late, 1);
  // First: address 1, bank 10, data 40. Second: its data follow at once.
  EXPECT_EQ(late.nodes[0].finish, 51 + 40 + 8 * 3);
  EXPECT_EQ(late.references().all_misses(), 1);
}

TEST(Prefetch, AWalkThroughATreeMissesTheRootOnly) {
  // Every branch below a complete tree, parents first; a cache that holds all.
  accel::Topology topology;
  topology.nodes.push_back({1, 8, 1, false});
  for (std::uint32_t i = 0; i < 8; ++i) {
    topology.nodes.push_back({9 + 8 * i, 8, 2, false});
  }
  topology.nodes.insert(topology.nodes.end(), 64, accel::TopologyNode{0, 0, 3, true});
  std::vector<std::uint32_t> words;
  for (std::uint32_t branch = 0; branch < 9; ++branch) {
    words.push_back(make_word(Step::branch, branch));
    for (std::uint32_t leaf = 8 * branch + 1; branch > 0 && leaf < 8 * branch + 9; ++leaf) {
      words.push_back(make_word(Step::leaf, leaf));
    }
  }
  const WorkLog log = row_of(1, words, std::move(topology));
  for (const memory::NodeOrder order : {memory::NodeOrder::breadth_first, memory::NodeOrder::depth_first}) {
    for (const CacheOrganisation organisation : {CacheOrganisation::unified, CacheOrganisation::split}) {
      MachineConfig machine;
      machine.nodes = 1;
      machine.layout.node_order = order;
      machine.cache.organisation = organisation;
      const std::int64_t lines = (73 * 8 + 31) / 32;
      EXPECT_EQ(replay(log, machine).references().all_misses(), lines);
      machine.prefetch.children = true;
      const MachineResult with = replay(log, machine);
      EXPECT_EQ(with.references().all_misses(), 1);
      EXPECT_EQ(with.contexts.counts().issued, lines - 1);
      EXPECT_EQ(with.contexts.counts().useless, 0);
    }
  }
}

TEST(Prefetch, TooManyAtATimeAreDropped) {
  const WorkLog log = row_of(1, {make_word(Step::branch, 0)}, one_branch());
  MachineConfig machine;
  machine.nodes = 1;
  machine.layout.node_bytes = 32;  // a line each
  machine.prefetch.children = true;
  machine.prefetch.outstanding = 3;
  const ContextCounts counts = replay(log, machine).contexts.counts();
  EXPECT_EQ(counts.issued, 3);
  EXPECT_EQ(counts.dropped, 5);
  EXPECT_EQ(counts.useless, 3);
}

TEST(Contexts, TheyShareTheCacheAndJoinEachOthersMisses) {
  // Two contexts read the same line at the same time: one miss, one that joins it.
  const WorkLog log = row_of(2, {make_word(Step::branch, 0)}, one_branch());
  MachineConfig machine;
  machine.nodes = 1;
  machine.contexts = 2;
  machine.packets = {1, 1, PacketOrder::scanline};
  machine.interconnect.latency_cycles = 10'000;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  const MachineResult result = replay(log, machine);
  EXPECT_EQ(result.references().all_misses(), 1);
  EXPECT_EQ(result.references().all_hits(), 1);
  EXPECT_EQ(result.contexts.counts().joined, 1);
}

TEST(Contexts, RefusesWhatCannotBe) {
  test::Random random(5);
  const WorkLog log = test::random_log(random, 4, 4);
  const auto refused = [&](const MachineConfig& machine) {
    EXPECT_THROW((void)replay(log, machine), sim::UserError);
  };
  MachineConfig machine;
  machine.contexts = 0;
  refused(machine);
  machine.contexts = most_contexts + 1;
  refused(machine);
  machine = {};
  machine.contexts = 2;
  machine.build.sharing = Sharing::shared;
  refused(machine);
  machine = {};
  machine.contexts = 2;
  machine.scheme = Scheme::pipeline;
  refused(machine);
  machine = {};
  machine.prefetch.next_line = true;
  machine.cache.organisation = CacheOrganisation::none;
  refused(machine);
  machine = {};
  machine.contexts = 2;
  machine.placement = Placement::distributed;
  refused(machine);
  machine.placement = Placement::shared;
  machine.l2.sharing = SecondLevel::private_caches;
  refused(machine);
  machine = {};
  machine.prefetch.next_line = true;
  machine.placement = Placement::replicated;
  refused(machine);
  machine = {};
  machine.prefetch.children = true;
  machine.prefetch.outstanding = 0;
  refused(machine);
  machine.prefetch.outstanding = 1;
  EXPECT_NO_THROW((void)replay(log, machine));
  WorkLog grid = log;
  grid.traversal = accel::Traversal::grid;
  EXPECT_THROW((void)replay(grid, machine), sim::UserError) << "the cells of a grid are not children";
}

}  // namespace
}  // namespace marti::processors
