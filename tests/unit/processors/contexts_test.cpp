// Nodes with contexts and prefetching: against nodes without, against a plain second implementation and
// against closed forms. The laws of all machines are in tests/contract.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <utility>
#include <vector>

#include "processors/replay/replay.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/random_flow.h"
#include "tests/unit/processors/naive_contexts.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace node;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

MachineConfig random_contexts(test::Random& random, const WorkLog& log, std::uint32_t most_nodes = 8) {
  MachineConfig machine = test::random_machine(random, most_nodes);
  const bool tree = log.traversal < accel::Traversal::grid || accel::walks_bvh(log.traversal);
  test::add_random_contexts(random, tree, machine);
  return machine;
}

RC_GTEST_PROP(Contexts, OneContextDoesWhatNodesWithoutContextsDo, (std::uint64_t seed)) {
  test::Random random(seed);
  for (const bool builds : {false, true}) {
    const WorkLog log = builds ? test::random_log_with_tree(random) : test::small_log(random);
    MachineConfig machine = test::random_machine(random);
    if (builds) {
      test::add_random_build(random, machine);
    }
    MachineResult one = replay::replay(log, machine, {.with_contexts = true});
    RC_ASSERT(one.contexts.counts().switches == 0);
    one.contexts.nodes.clear();
    test::expect_equal(replay::replay(log, machine), one);
    RC_ASSERT(!::testing::Test::HasFatalFailure());
  }
}

RC_GTEST_PROP(Contexts, ThePlainImplementationGivesTheSame, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  MachineConfig machine = random_contexts(random, log);
  for (memory::CacheConfig* const cache : {&machine.cache.cache, &machine.l2.cache}) {
    if (cache->replacement != memory::Replacement::fifo) {
      cache->replacement = memory::Replacement::lru;
    }
  }
  if (random() % 3 == 0) {
    machine.layout.section_alignment = 1U << test::pick(random, 0, 4);  // kinds of record share lines
  }
  if (random() % 2 == 0) {
    machine.count = {machine.cache.organisation != CacheOrganisation::none, true, true};
  }
  const MachineResult result = replay::replay(log, machine, {.with_contexts = true});
  test::NaiveCounts counts(machine);
  MachineResult plain = test::NaiveContexts(log, machine, &counts).run();
  counts.expect(result.counts, true);
  if (machine.l2.sharing != SecondLevel::private_caches) {
    plain.l2 = result.l2;  // it does not count what a shared second level does, nor steps
  }
  for (std::size_t node = 0; node < plain.nodes.size(); ++node) {
    plain.nodes[node].steps = result.nodes[node].steps;
  }
  test::expect_equal(result, plain);
  RC_ASSERT(!::testing::Test::HasFailure());
}

// A random machine whose nodes build the tree and have several contexts or prefetch.
MachineConfig random_builders(test::Random& random, const WorkLog& log) {
  MachineConfig machine = test::random_machine(random, 8);
  test::add_random_build(random, machine);
  test::add_random_contexts(random, log.traversal < accel::Traversal::grid, machine);
  return machine;
}

// Ties nodes that build to those of which there is a plain implementation.
RC_GTEST_PROP(Contexts, NodesWithNothingToBuildAreThoseWithAGivenTree, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log_with_tree(random);
  MachineConfig machine = random_builders(random, log);
  const std::vector<BranchStart> kept(log.topology.nodes.size(), BranchStart::kept);
  MachineResult built = replay::replay(log, machine, {.starts = kept, .with_contexts = true});
  machine.build = {};
  const MachineResult given = replay::replay(log, machine, {.with_contexts = true});
  built.build = given.build;
  test::expect_equal(built, given);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
}

TEST(Contexts, RandomBuildersDoAllThereIsToDo) {
  ContextCounts contexts;
  BuildCounts built;
  sim::Sum lock_wait = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    test::Random random(seed);
    const WorkLog log = test::random_tree_log(random, 8, 8);
    const MachineResult result = replay::replay(log, random_builders(random, log));
    sim::merge(contexts, result.contexts.counts());
    sim::merge(built, result.build.counts());
    lock_wait += result.time()[static_cast<std::size_t>(Activity::lock_wait)];
  }
  sim::for_each_counter(contexts, [](const sim::Counter<ContextCounts>& counter, std::int64_t value) {
    EXPECT_GT(value, 100) << counter.name;
  });
  sim::for_each_counter(built, [](const sim::Counter<BuildCounts>& counter, std::int64_t value) {
    EXPECT_GT(value, 100) << counter.name;
  });
  EXPECT_GT(lock_wait, 100);
}

// Checks that the properties above meet every kind of event that is counted.
TEST(Contexts, RandomMachinesDoAllThereIsToDo) {
  ContextCounts sum;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    test::Random random(seed);
    const WorkLog log = test::small_log(random);
    sim::merge(sum, replay::replay(log, random_contexts(random, log)).contexts.counts());
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
  return replay::replay(log, machine).end;
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

// Two nodes visit the root of a tree that is there, which prefetches the records of its children, and one of
// them splits the first child. Its write takes that record out of the other's cache, which never referred to
// it.
TEST(Contexts, AStaleCopyThatWasPrefetchedIsTakenOut) {
  WorkLog log;
  log.traversal = accel::Traversal::octree;
  log.width = 2;
  log.height = 1;
  log.texture_begin = {0};
  log.topology.nodes.push_back({1, 8, 1, false});
  log.topology.nodes.push_back({9, 8, 2, false});
  log.topology.nodes.insert(log.topology.nodes.end(), 7, accel::TopologyNode{0, 0, 2, true});
  log.topology.nodes.insert(log.topology.nodes.end(), 8, accel::TopologyNode{0, 0, 3, true});
  log.topology.work.resize(log.topology.nodes.size());
  log.rows.resize(1);
  log.rows[0].words = {make_word(Step::branch, 0), make_word(Step::branch, 0), make_word(Step::branch, 1)};
  log.rows[0].begin = {0, 1, 3};
  MachineConfig machine;
  machine.nodes = 2;
  machine.layout.node_bytes = machine.cache.cache.line;  // each record has a line of its own
  machine.host.assignment = Assignment::interleaved;
  machine.packets = {1, 1, PacketOrder::scanline};
  machine.prefetch.children = true;
  machine.prefetch.outstanding = 8;
  machine.build.sharing = Sharing::shared;
  std::vector<BranchStart> starts(log.topology.nodes.size(), BranchStart::kept);
  starts[1] = BranchStart::lazy;
  const MachineResult result = replay::replay(log, machine, {.starts = starts});
  EXPECT_EQ(result.build.counts().splits, 1);
  EXPECT_EQ(result.build.counts().invalidations, 1);
}

TEST(Contexts, RefusesWhatCannotBe) {
  test::Random random(5);
  const WorkLog log = test::random_log(random, 4, 4);
  for (const auto& spoil :
       {+[](MachineConfig& m) { m.contexts = 0; }, +[](MachineConfig& m) { m.contexts = most_contexts + 1; },
        +[](MachineConfig& m) { m.scheme = Scheme::pipeline; },
        +[](MachineConfig& m) {
          m.prefetch.next_line = true;
          m.cache.organisation = CacheOrganisation::none;
        },
        +[](MachineConfig& m) {
          m.prefetch.next_line = true;
          m.placement = Placement::replicated;
        },
        +[](MachineConfig& m) {
          m.prefetch.children = true;
          m.prefetch.outstanding = 0;
        }}) {
    MachineConfig machine;
    machine.contexts = 2;
    EXPECT_NO_THROW((void)replay::replay(log, machine));
    spoil(machine);
    EXPECT_THROW((void)replay::replay(log, machine), sim::UserError);
  }
  MachineConfig machine;
  machine.prefetch.children = true;
  machine.prefetch.outstanding = 1;
  WorkLog walked = log;
  walked.traversal = accel::Traversal::octree;
  EXPECT_NO_THROW((void)replay::replay(walked, machine));
  walked.traversal = accel::Traversal::grid;
  EXPECT_THROW((void)replay::replay(walked, machine), sim::UserError)
      << "the cells of a grid are not children";
}

}  // namespace
}  // namespace marti::processors
