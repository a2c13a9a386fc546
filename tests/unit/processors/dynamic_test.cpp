// Building the tree on the simulated machine, against the static machine, closed forms, and the branches that
// the log needs. The laws of all machines are in tests/contract.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <numeric>
#include <optional>
#include <set>

#include "processors/cost/build_mix.h"
#include "processors/cost/step_time.h"
#include "processors/node/memory_system.h"
#include "processors/replay/replay.h"
#include "processors/walk/record_places.h"
#include "processors/walk/tree_plan.h"
#include "tests/support/equal_results.h"
#include "tests/support/logged_samples.h"
#include "tests/support/random_machine.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace node;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

struct Case {
  WorkLog log;
  MachineConfig machine;
  ReplayOptions options;
};

Case random_case(test::Random& random) {
  Case c{test::random_tree_log(random, static_cast<std::uint32_t>(test::pick(random, 1, 10)),
                               static_cast<std::uint32_t>(test::pick(random, 1, 10))),
         test::random_machine(random),
         {}};
  test::add_random_build(random, c.machine);
  if (random() % 3 == 0) {
    c.options.starts = test::random_starts(random, c.log.topology, c.machine.build.sharing != Sharing::none);
  }
  return c;
}

// All results except the build, which a machine with a given tree does not report.
RC_GTEST_PROP(Dynamic, ATreeThatIsKeptIsATreeThatIsGiven, (std::uint64_t seed)) {
  test::Random random(seed);
  Case c = random_case(random);
  c.options.starts.assign(c.log.topology.nodes.size(), BranchStart::kept);
  MachineResult kept = replay::replay(c.log, c.machine, c.options);
  RC_ASSERT(kept.build.start_up == 0);
  RC_ASSERT(kept.build.counts().written_bytes == 0);
  RC_ASSERT(kept.build.all_levels().partial == 0);
  kept.build = {};
  c.machine.build.sharing = Sharing::given;
  test::expect_equal(kept, replay::replay(c.log, c.machine));
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

RC_GTEST_PROP(Dynamic, AFullInitialTreeIsBuildingBeforehandHoweverItIsShared, (std::uint64_t seed)) {
  test::Random random(seed);
  Case c = random_case(random);
  c.options.starts.clear();
  c.machine.build.initial = InitialTree::full;
  c.machine.build.sharing = Sharing::none;
  const MachineResult none = replay::replay(c.log, c.machine, c.options);
  for (const Sharing sharing : {Sharing::shared, Sharing::private_trees}) {
    const bool in_order = c.machine.placement == Placement::shared && !writes_done_later(c.machine);
    if (sharing == Sharing::private_trees || in_order) {
      c.machine.build.sharing = sharing;
      test::expect_equal(replay::replay(c.log, c.machine, c.options), none);
      RC_ASSERT(!::testing::Test::HasFatalFailure());
    }
  }
}

RC_GTEST_PROP(Dynamic, TreesAreBuiltAsFarAsTheRaysNeedThemByAnyNumberOfNodes, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_tree_log(random, 8, 8);
  MachineConfig machine = test::random_machine(random);
  machine.build = test::random_build(random);
  machine.build.sharing = Sharing::shared;
  test::share_in_order(machine);
  machine.clusters = 1;
  const std::vector<BranchStart> starts = branch_starts(log.topology, machine.build);
  // A lazy branch is there when its parent is split, and split when a ray visits it.
  std::vector<std::int64_t> splits(256);
  std::vector<std::int64_t> partial(256);
  const std::set<std::uint32_t> visited = test::visited_branches(log);
  std::vector<bool> there(starts.size(), true);
  for (std::uint32_t number = 0; number < starts.size(); ++number) {
    const accel::TopologyNode& node = log.topology.nodes[number];
    const bool split = starts[number] != BranchStart::lazy || visited.contains(number);
    for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
      there[node.first + child] = there[number] && split;
    }
    if (!node.leaf && starts[number] == BranchStart::lazy) {
      splits[node.level] += split ? 1 : 0;
      partial[node.level] += there[number] && !split ? 1 : 0;
    }
  }
  for (const std::uint32_t nodes : {1U, 2U, 3U, 16U}) {
    machine.nodes = nodes;
    machine.build.sharing = Sharing::shared;
    const MachineResult result = replay::replay(log, machine);
    for (std::size_t level = 0; level < result.build.levels.size(); ++level) {
      RC_ASSERT(result.build.levels[level].splits == splits[level + 1]);
      RC_ASSERT(result.build.levels[level].partial == partial[level + 1]);
    }
    RC_ASSERT(result.build.wasted_splits() == 0);
    if (nodes == 1) {
      RC_ASSERT(result.build.counts().waits == 0);
      RC_ASSERT(result.build.counts().invalidations == 0);
    }
    // Of private trees some node splits each of these branches, and no node others or one twice.
    machine.build.sharing = Sharing::private_trees;
    const std::int64_t all = std::accumulate(splits.begin(), splits.end(), std::int64_t{0});
    const MachineResult own = replay::replay(log, machine);
    RC_ASSERT(own.build.all_levels().distinct_splits == all);
    RC_ASSERT(own.build.counts().splits <= all * nodes);
  }
}

RC_GTEST_PROP(Dynamic, OneNodeBuildsThePrivateTreeThatItWouldShare, (std::uint64_t seed)) {
  test::Random random(seed);
  Case c = random_case(random);
  c.machine.clusters = 1;
  c.machine.nodes = 1;
  test::share_in_order(c.machine);
  c.machine.build.sharing = Sharing::shared;
  const MachineResult shared = replay::replay(c.log, c.machine, c.options);
  c.machine.build.sharing = Sharing::private_trees;
  const MachineResult own = replay::replay(c.log, c.machine, c.options);
  const BuildCounts a = shared.build.counts();
  const BuildCounts b = own.build.counts();
  RC_ASSERT(a.splits == b.splits);
  RC_ASSERT(a.start_up_splits == b.start_up_splits);
  RC_ASSERT(a.listed == b.listed);
  RC_ASSERT(a.overlaps == b.overlaps);
  RC_ASSERT(a.children == b.children);
  RC_ASSERT(a.entries == b.entries);
  RC_ASSERT(a.written_bytes == b.written_bytes);
  RC_ASSERT(a.locks == a.splits && b.locks == 0);
  // The initial tree is the database's, and so is its cost.
  RC_ASSERT(shared.build.start_up == own.build.start_up);
  test::expect_equal_counters(shared.steps(), own.steps());
  for (std::size_t level = 0; level < shared.build.levels.size(); ++level) {
    RC_ASSERT(shared.build.levels[level].branches == own.build.levels[level].branches);
    RC_ASSERT(shared.build.levels[level].leaves == own.build.levels[level].leaves);
    RC_ASSERT(shared.build.levels[level].partial == own.build.levels[level].partial);
    RC_ASSERT(shared.build.levels[level].list_bytes == own.build.levels[level].list_bytes);
  }
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

RC_GTEST_PROP(Dynamic, WhatTheRaysDoDoesNotDependOnHowTheTreeIsBuilt, (std::uint64_t seed)) {
  test::Random random(seed);
  Case c = random_case(random);
  const MachineResult built = replay::replay(c.log, c.machine, c.options);
  c.machine.build.sharing = Sharing::given;
  test::expect_equal_counters(built.steps(), replay::replay(c.log, c.machine).steps());
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

// A root with two leaves below it, one primitive in each: what the tests of closed forms split.
WorkLog tiny_log(std::uint32_t pixels) {
  WorkLog log;
  log.width = pixels;
  log.height = 1;
  log.primitives = 2;
  log.materials = 1;
  log.texture_begin = {0};
  log.topology.nodes = {{1, 2, 1, false}, {0, 1, 2, true}, {1, 1, 2, true}};
  log.topology.entries = {0, 1};
  log.topology.work = {{2, 3}, {1, 0}, {1, 0}};
  LogRow& row = log.rows.emplace_back();
  for (std::uint32_t x = 0; x < pixels; ++x) {
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
    row.words.push_back(make_word(Step::branch, 0));
  }
  row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  return log;
}

// Every reference goes to memory and takes `latency`; writes are posted and never fill the buffer.
MachineConfig tiny_machine(std::uint32_t nodes) {
  MachineConfig machine;
  machine.nodes = nodes;
  machine.clock = sim::Clock::from_period(1);
  machine.cache.organisation = CacheOrganisation::none;
  machine.banks.interleave = 64;
  machine.layout.primitive_bytes = 32;  // no record lies across two units
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.clock = sim::Clock::from_period(1000);
  machine.interconnect.latency_cycles = 10;
  machine.host.assignment = Assignment::interleaved;
  machine.packets = {1, 1, PacketOrder::scanline};
  machine.write_buffer = 64;
  machine.build = {Sharing::shared, InitialTree::level, 1, 10.0};
  return machine;
}

constexpr sim::Ticks latency = 10'000;

TEST(Dynamic, ATinyTreeIsBuiltInTheTimeThatItsPartsTake) {
  const MachineConfig machine = tiny_machine(1);
  const BuildTicks build = build_ticks(machine);
  const StepTicks step = step_ticks(machine, tiny_log(1));
  const MachineResult result = replay::replay(tiny_log(1), machine);
  // The root's record, the lock, the list of two, two primitives; then the children and the root are written.
  const sim::Ticks compute =
      build.lock + 2 * build.listed + 3 * build.overlap + 2 * (build.child + build.entry) + build.publish;
  EXPECT_EQ(result.nodes[0].finish, step.branch + step.pixel + compute + 5 * latency);
  EXPECT_EQ(result.nodes[0].time[static_cast<std::size_t>(Activity::building)], compute);
  EXPECT_EQ(result.end, result.nodes[0].finish + latency) << "the pixel's write is the last";
  const BuildCounts counts = result.build.counts();
  EXPECT_EQ(counts.written_bytes, 3 * 8 + 2 * 4);
  EXPECT_EQ(counts.writes, 5);
  EXPECT_EQ(counts.locks, 1);
  ASSERT_EQ(result.build.levels.size(), 2U);
  EXPECT_EQ(result.build.levels[0].branches, 1);
  EXPECT_EQ(result.build.levels[0].released_bytes, 2 * 4);
  EXPECT_EQ(result.build.levels[1].leaves, 2);
  EXPECT_EQ(result.build.levels[1].node_bytes, 2 * 8);
  EXPECT_EQ(result.build.levels[1].list_bytes, 2 * 4);
}

TEST(Dynamic, WhoComesSecondWaitsUntilTheTreeIsPublished) {
  const MachineConfig machine = tiny_machine(2);
  const BuildTicks build = build_ticks(machine);
  const StepTicks step = step_ticks(machine, tiny_log(1));
  const MachineResult result = replay::replay(tiny_log(2), machine);
  const sim::Ticks work =
      2 * build.listed + 3 * build.overlap + 2 * (build.child + build.entry) + build.publish + 3 * latency;
  // Both have made their lock transactions at the same time; the second can go on when the publishing write
  // is done, and reads the root again.
  EXPECT_EQ(result.nodes[1].time[static_cast<std::size_t>(Activity::lock_wait)], work + latency);
  EXPECT_EQ(result.nodes[0].time[static_cast<std::size_t>(Activity::lock_wait)], 0);
  EXPECT_EQ(result.nodes[1].finish,
            step.branch + build.lock + 2 * latency + work + latency + latency + step.pixel);
  EXPECT_EQ(result.build.nodes[1].rereads, 1);
  EXPECT_EQ(result.build.nodes[1].waits, 1);
  EXPECT_EQ(result.build.nodes[1].splits, 0);
}

TEST(Dynamic, BuildingBeforehandKeepsTheHostWaiting) {
  MachineConfig machine = tiny_machine(2);
  machine.build.sharing = Sharing::none;
  const BuildTicks build = build_ticks(machine);
  const StepTicks step = step_ticks(machine, tiny_log(1));
  const MachineResult result = replay::replay(tiny_log(2), machine);
  // No lock; the last write is done one latency after it was posted.
  const sim::Ticks start_up = 2 * build.listed + 3 * build.overlap + 2 * (build.child + build.entry) +
                              build.publish + 4 * latency + latency;
  EXPECT_EQ(result.build.start_up, start_up);
  EXPECT_EQ(result.nodes[1].time[static_cast<std::size_t>(Activity::dispatch_wait)], start_up);
  EXPECT_EQ(result.nodes[0].time[static_cast<std::size_t>(Activity::dispatch_wait)], latency);
  EXPECT_EQ(result.nodes[1].finish, start_up + step.branch + latency + step.pixel);
}

TEST(Dynamic, WhatIsBuiltBeforehandWaitsForNoPrefetch) {
  MachineConfig machine = tiny_machine(1);
  machine.build.sharing = Sharing::none;
  machine.cache.organisation = CacheOrganisation::unified;
  machine.cache.cache.line = 64;
  // Primitives lie in one bank and are slow to read, what is written lies in others.
  machine.interconnect.kind = memory::InterconnectKind::crossbar;
  machine.interconnect.width = 1;
  machine.banks.count = 64;
  machine.banks.interleave = 4096;
  machine.banks.clock = machine.interconnect.clock;
  WorkLog log = tiny_log(1);
  log.primitives = 4;  // of which the tree lists the first two, which fill a line
  const MachineResult without = replay::replay(log, machine);
  machine.prefetch.next_line = true;
  machine.prefetch.outstanding = 4;
  const MachineResult with = replay::replay(log, machine);
  EXPECT_EQ(with.contexts.counts().issued, 1)
      << "the line of the other two, which comes after the last write";
  EXPECT_EQ(with.build.start_up, without.build.start_up);
}

TEST(Dynamic, WhatIsBuiltBeginsWhereARecordMay) {
  MachineConfig machine = tiny_machine(1);
  machine.build.sharing = Sharing::shared;
  machine.layout.section_alignment = 1;
  machine.layout.record_alignment = 64;
  const WorkLog log = tiny_log(1);
  std::optional<walk::TreePlan> plan = walk::tree_plan_of(log, machine);
  const memory::Layout layout = walk::layout_of(log, machine, plan);
  EXPECT_NE(layout.end() % 64, 0U);
  EXPECT_EQ(plan.value().first_block() % 64, 0U);
}

TEST(Dynamic, PrivateTreesAreBuiltTwiceInMemoryOfTheirOwn) {
  MachineConfig machine = tiny_machine(2);
  machine.build.sharing = Sharing::private_trees;
  machine.local.clock = sim::Clock::from_period(100);
  machine.local.access_cycles = 3;
  machine.local.cycles_per_beat = 2;
  machine.local.width = 4;
  const BuildTicks build = build_ticks(machine);
  const StepTicks step = step_ticks(machine, tiny_log(1));
  const MachineResult result = replay::replay(tiny_log(2), machine);
  const auto local = [](std::int64_t beats) { return sim::Ticks{300 + 200 * beats}; };
  // The empty slot is read, then the shared record, the shared list and two primitives; written are two
  // lists of one entry, two records and the slot.
  const sim::Ticks work = local(2) + 4 * latency + 2 * build.listed + 3 * build.overlap +
                          2 * (build.child + build.entry) + build.publish + 2 * local(1) + 3 * local(2);
  for (const NodeStatistics& node : result.nodes) {
    EXPECT_EQ(node.finish, step.branch + work + step.pixel);
    EXPECT_EQ(node.time[static_cast<std::size_t>(Activity::lock_wait)], 0);
  }
  EXPECT_EQ(result.build.counts().splits, 2);
  EXPECT_EQ(result.build.wasted_splits(), 1);
  EXPECT_EQ(result.build.levels[0].branches, 2);
  EXPECT_EQ(result.build.levels[1].leaves, 4);
}

TEST(Dynamic, AStaleCopyOfTheRecordIsTakenOutOfTheOthersCaches) {
  MachineConfig machine = tiny_machine(3);
  machine.cache.organisation = CacheOrganisation::unified;
  const MachineResult result = replay::replay(tiny_log(30), machine);
  // All three have read the root's record before one of them publishes it; two copies are stale.
  EXPECT_EQ(result.build.counts().invalidations, 2);
  EXPECT_EQ(result.build.counts().splits, 1);
  EXPECT_EQ(result.references().misses[static_cast<std::size_t>(memory::RecordKind::node)], 3 + 2);
}

TEST(Dynamic, TheRuleStopsAtTheFirstLevelWithEnoughLeaves) {
  accel::Topology topology;
  // Level 1: one branch. Level 2: seven leaves, one branch. Level 3: eight leaves.
  topology.nodes.push_back({1, 8, 1, false});
  for (int i = 0; i < 7; ++i) {
    topology.nodes.push_back({0, 0, 2, true});
  }
  topology.nodes.push_back({9, 8, 2, false});
  topology.nodes.insert(topology.nodes.end(), 8, {0, 0, 3, true});
  topology.work.resize(topology.nodes.size());
  BuildConfig build{Sharing::shared, InitialTree::rule, 1, 3.0};
  EXPECT_EQ(initial_level(topology, build), 2U);
  build.rule_k = 7.0;  // seven are not more than seven times one
  EXPECT_EQ(initial_level(topology, build), 3U);
  build.rule_k = 0.0;
  EXPECT_EQ(initial_level(topology, build), 2U);
  build.initial = InitialTree::full;
  EXPECT_EQ(initial_level(topology, build), 4U);
  build = {Sharing::shared, InitialTree::level, 200, 0.0};
  EXPECT_EQ(initial_level(topology, build), 4U);
  build.level = 1;
  EXPECT_EQ(branch_starts(topology, build)[0], BranchStart::lazy);
  build.sharing = Sharing::none;
  EXPECT_EQ(branch_starts(topology, build)[8], BranchStart::eager);
}

TEST(Dynamic, RefusesWhatHasNoTreeToBuild) {
  test::Random random(5);
  WorkLog log = test::random_tree_log(random, 3, 3);
  log.topology = test::random_topology(random, 5, log.primitives, 6);
  log.rows = test::random_tree_log(random, 3, 3).rows;
  MachineConfig machine;
  machine.build.sharing = Sharing::shared;
  const auto refused = [&](const ReplayOptions& options, const std::string& why) {
    const std::string message = test::user_error_of([&] { (void)replay::replay(log, machine, options); });
    EXPECT_PRED_FORMAT2(testing::IsSubstring, why, message);
  };
  refused({}, "build.sharing: only an octree");
  machine.placement = Placement::replicated;
  refused({}, "build.sharing: nodes with a database each");
  machine.placement = Placement::distributed;
  refused({}, "build.sharing: \"shared\" does not combine with database.placement = \"distributed\"");
  machine.placement = Placement::shared;
  machine.interconnect.arbitration = memory::Arbitration::round_robin;
  refused({}, "build.sharing: a read may overtake another node's write on a bus");
  machine = {};
  refused({.starts = {BranchStart::kept}}, "build.sharing: start states");
  machine.build.sharing = Sharing::none;
  refused({.starts = {BranchStart::kept}}, "the tree has");
  test::add_random_work(random, log.topology);
  std::vector<BranchStart> starts(log.topology.nodes.size(), BranchStart::lazy);
  refused({.starts = starts}, "\"none\" leaves no branch");
  machine.build.sharing = Sharing::shared;
  for (std::size_t node = 1; node < starts.size(); ++node) {
    starts[node] = BranchStart::eager;
  }
  refused({.starts = starts}, "its parent is not");
  machine.build = {Sharing::shared, InitialTree::level, 0, 10.0};
  refused({}, "build.initial_level");
}

}  // namespace
}  // namespace marti::processors
