// The critical path: laws on random machines of every kind, and a second way to find it on plain ones.
#include "processors/path/critical_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "processors/path/path_recorder.h"
#include "processors/replay/replay.h"
#include "sim/key_error.h"
#include "tests/support/equal_results.h"
#include "tests/support/long_tests.h"
#include "tests/support/naive_pipeline.h"
#include "tests/support/naive_space.h"
#include "tests/support/random_flow.h"
#include "tests/support/user_error.h"
#include "tests/unit/processors/naive_path.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace path;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

const sim::MemoryBudget unlimited;

sim::Ticks of(const CriticalPath& path, PathKind kind) { return path.time[static_cast<std::size_t>(kind)]; }

// Passes everything on to a recorder, and keeps what each node did when.
class Watched final : public Observer {
 public:
  explicit Watched(PathRecorder& recorder) : recorder_(recorder) {}
  void begin(const ReplayInput& input) override { recorder_.begin(input); }
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override {
    recorder_.spent(node, state, from, to, pixel);
    if (state == NodeState::working) {
      work.resize(std::max<std::size_t>(work.size(), node + 1));
      work[node].push_back({from, to});
    } else if (state == NodeState::lock_wait || state == NodeState::dispatch_wait ||
               state == NodeState::message_wait || state == NodeState::queue_full_wait) {
      let_go.emplace(node, to);
    }
  }
  void end(sim::Ticks time) override { recorder_.end(time); }

  // Whether a node worked from `from` to `to` without a break.
  [[nodiscard]] bool worked(std::uint32_t node, sim::Ticks from, sim::Ticks to) const {
    if (node >= work.size()) {
      return false;
    }
    const auto behind = std::ranges::upper_bound(work[node], from, {}, &Work::from);
    return behind != work[node].begin() && to <= std::prev(behind)->to;
  }

  struct Work {
    sim::Ticks from, to;
  };
  std::vector<std::vector<Work>> work;                    // of each node, in the order of time
  std::set<std::pair<std::uint32_t, sim::Ticks>> let_go;  // when other nodes or the host ended a node's wait

 private:
  PathRecorder& recorder_;
};

struct Case {
  WorkLog log;
  MachineConfig machine;
};

// A random machine of the image scheme, with a tree to be built or given, contexts, prefetching, second
// levels.
Case random_case(test::Random& random) {
  const bool builds = random() % 2 == 0;
  Case c;
  c.log = builds ? test::random_tree_log(random, static_cast<std::uint32_t>(test::pick(random, 1, 8)),
                                         static_cast<std::uint32_t>(test::pick(random, 1, 8)))
                 : test::small_log(random, 8);
  c.machine = test::random_machine(random, 8);
  if (builds) {
    test::add_random_build(random, c.machine);
  } else {
    test::add_random_second_level(random, c.machine);
  }
  if (random() % 2 == 0) {
    test::add_random_contexts(random, c.log.traversal < accel::Traversal::grid, c.machine);
  }
  if (random() % 4 == 0) {
    c.machine.count.attribution = true;  // nodes that count are another class
  }
  return c;
}

// A random machine in which rays move.
Case random_flow(test::Random& random) {
  Case c;
  c.log = test::random_log_with_tree(random);
  c.machine = test::random_machine(random, 8);
  random() % 2 == 0 ? test::make_random_pipeline(random, c.machine)
                    : test::make_random_space(random, c.machine);
  test::add_random_second_level(random, c.machine);
  if (c.machine.scheme == Scheme::space && c.machine.l2.sharing == SecondLevel::shared) {
    c.machine.l2.sharing = SecondLevel::none;  // nothing is shared
  }
  c.machine.count.attribution = random() % 4 == 0;
  return c;
}

// A random machine that prefetches into its caches from private second levels which take long to answer, so
// that a prefetch may end the frame.
Case slow_second_level(test::Random& random) {
  Case c;
  c.log = test::random_tree_log(random, 4, 4);
  c.machine = test::random_machine(random, 6);
  if (random() % 2 == 0) {
    c.machine.build = test::random_build(random);
    test::share_in_order(c.machine);
  }
  if (c.machine.placement == Placement::replicated) {
    c.machine.placement = Placement::shared;
  }
  if (c.machine.cache.organisation == CacheOrganisation::none) {
    c.machine.cache.organisation = CacheOrganisation::unified;
    c.machine.distribution.interleave = c.machine.cache.cache.line;
  }
  test::add_random_contexts(random, c.log.traversal < accel::Traversal::grid, c.machine);
  c.machine.l2.sharing = SecondLevel::private_caches;
  c.machine.l2.hit_cycles = test::pick(random, 200, 1000);
  c.machine.l2.cache.line = c.machine.cache.cache.line;
  c.machine.l2.cache.replacement = memory::Replacement::lru;
  c.machine.l2.cache.ways = 2;
  c.machine.l2.cache.size = std::uint64_t{c.machine.cache.cache.line} * 64;
  c.machine.prefetch.next_line = true;
  return c;
}

// Whether each transaction ends with a piece of its own. Else it may end with what kept it waiting.
bool every_transaction_takes_time(const MachineConfig& machine) {
  return machine.interconnect.cycles_per_beat > 0 && machine.interconnect.latency_cycles > 0 &&
         machine.banks.access_cycles > 0 && machine.local.access_cycles > 0 &&
         machine.network.cycles_per_beat > 0 && machine.network.hop_cycles > 0 &&
         machine.host.latency_cycles > 0;
}

TEST(CriticalPath, ItsPiecesFollowEachOtherFromZeroToTheEnd) {
  const int slow = test::cases(1000);
  const int flow = slow + test::cases(200);
  sim::Ticks all_traversal = 0;
  std::int64_t all_reads = 0;
  for (int seed = 0; seed < flow + test::cases(500); ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(static_cast<std::uint64_t>(seed));
    const Case c = seed < slow   ? random_case(random)
                   : seed < flow ? slow_second_level(random)
                                 : random_flow(random);
    PathRecorder recorder(unlimited, PathPieces::no_fold);
    Watched watched(recorder);
    const MachineResult result = replay::replay(c.log, c.machine, {.observer = &watched, .path = &recorder});
    test::expect_equal(result, replay::replay(c.log, c.machine));
    const CriticalPath& path = recorder.path();
    const sim::Ticks latency = c.machine.host.clock.cycles(c.machine.host.latency_cycles);
    const sim::Ticks occupancy = c.machine.host.clock.cycles(c.machine.host.occupancy_cycles);
    const bool takes_time = every_transaction_takes_time(c.machine);
    EXPECT_EQ(path.end, result.end);
    EXPECT_EQ(std::reduce(path.time.begin(), path.time.end()), result.end);
    EXPECT_EQ(std::reduce(path.nodes.begin(), path.nodes.end()), result.end);
    EXPECT_EQ(path.nodes.size(), result.nodes.size());
    sim::Ticks at = result.end;
    std::int64_t changes = 0;       // of the node
    std::optional<PathPiece> next;  // the piece behind
    recorder.each_from_the_end([&](const PathPiece& piece) {
      ASSERT_EQ(piece.to, at);
      ASSERT_LT(piece.from, piece.to);
      at = piece.from;
      if (piece.kind == PathKind::dispatch) {
        const sim::Ticks length = piece.to - piece.from;
        ASSERT_TRUE(length == latency || length == occupancy);
      }
      // A node goes on after what it did or asked for itself, unless another node has let it go on.
      if (takes_time && next && is_own_work(next->kind) && piece.owner.node != next->owner.node) {
        ASSERT_TRUE(watched.let_go.contains({next->owner.node, next->from}));
      }
      changes += next && piece.owner.node != next->owner.node ? 1 : 0;
      // What a node does by itself lies within the time in which it worked, unless it is a prefetch from its
      // second level, which ends the frame.
      const bool prefetch = !next && piece.kind == PathKind::cache_access;
      next = piece;
      ASSERT_TRUE(!is_own_work(piece.kind) || prefetch ||
                  watched.worked(piece.owner.node, piece.from, piece.to));
    });
    EXPECT_EQ(at, 0);
    EXPECT_EQ(path.node_changes, changes);
    if (c.machine.placement == Placement::shared &&
        c.machine.interconnect.kind == memory::InterconnectKind::bus) {
      sim::Sum busy = 0;
      for (const ClusterResult& cluster : result.clusters) {
        busy += cluster.interconnect.busy;
      }
      EXPECT_LE(of(path, PathKind::transfer), busy);
    }
    sim::Ticks traversal = 0;
    for (const PathLevel& level : path.levels) {
      traversal += level.traversal;
      all_reads += level.reads;
    }
    EXPECT_LE(traversal, of(path, PathKind::traversal));
    all_traversal += traversal;
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
  EXPECT_GT(all_traversal, 0);
  EXPECT_GT(all_reads, 0);
}

TEST(CriticalPath, OfOneNodeOnAnIdealInterconnectIsHowItsTimeDivides) {
  for (std::uint64_t seed = 0; seed < test::cases(200U); ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const WorkLog log = test::small_log(random, 8);
    MachineConfig machine = test::random_machine(random, 1);
    machine.clusters = 1;
    machine.placement = Placement::shared;
    machine.interconnect.kind = memory::InterconnectKind::ideal;
    machine.write_buffer = 200;
    PathRecorder recorder(unlimited, PathPieces::no_fold);
    const MachineResult result = replay::replay(log, machine, {.observer = &recorder, .path = &recorder});
    const TimeDivision& time = result.nodes[0].time;
    const CriticalPath& path = recorder.path();
    // The frame may end with the last posted write, for which the node idles.
    const auto idle = time[static_cast<std::size_t>(Activity::idle)];
    for (std::size_t kind = 0; kind <= static_cast<std::size_t>(Activity::messaging); ++kind) {
      EXPECT_EQ(path.time[kind], time[kind]) << activity_names[kind];
    }
    EXPECT_EQ(of(path, PathKind::transfer), time[static_cast<std::size_t>(Activity::transfer)] + idle);
    EXPECT_EQ(of(path, PathKind::dispatch), time[static_cast<std::size_t>(Activity::dispatch_wait)]);
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

TEST(CriticalPath, OfOneNodeWithAllOfSpaceIsHowItsTimeDivides) {
  for (std::uint64_t seed = 0; seed < test::cases(60U); ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const WorkLog log = test::random_ray_trees(random, 6, 6, 12, 4);
    MachineConfig machine = test::random_machine(random, 1);
    test::make_random_space(random, machine);
    machine.clusters = 1;
    machine.nodes = 1;
    machine.network.kind = memory::NetworkKind::ideal;
    machine.host.occupancy_cycles = 0;
    machine.space.queue = machine.space.in_flight = 1000;  // all rays arrive at once
    PathRecorder recorder(unlimited, PathPieces::no_fold);
    const MachineResult result = replay::replay(log, machine, {.observer = &recorder, .path = &recorder});
    const TimeDivision& time = result.nodes[0].time;
    const auto spent = [&](Activity activity) { return time[static_cast<std::size_t>(activity)]; };
    const CriticalPath& path = recorder.path();
    for (std::size_t kind = 0; kind <= static_cast<std::size_t>(Activity::messaging); ++kind) {
      EXPECT_EQ(path.time[kind], time[kind]) << activity_names[kind];
    }
    EXPECT_EQ(of(path, PathKind::own_memory), spent(Activity::transfer) + spent(Activity::bank_access));
    EXPECT_EQ(of(path, PathKind::dispatch), machine.host.clock.cycles(machine.host.latency_cycles));
    EXPECT_EQ(of(path, PathKind::dispatch) + of(path, PathKind::network),
              spent(Activity::message_wait) + spent(Activity::idle));
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

// A pipeline of 4, 1 and 4 nodes for which nothing is slow.
MachineConfig pipeline_of_nine() {
  MachineConfig machine;
  machine.scheme = Scheme::pipeline;
  machine.pipeline = {4, 1, 4, 8, 0};
  machine.nodes = 9;
  machine.placement = Placement::replicated;
  machine.network.kind = memory::NetworkKind::ideal;
  return machine;
}

TEST(CriticalPath, OfAPipelineIsItsSlowestStageOrTheHost) {
  test::Random random(5);
  const WorkLog log = test::random_ray_trees(random, 20, 20, 12, 3);
  MachineConfig machine = pipeline_of_nine();
  PathRecorder slow_stage(unlimited);
  const MachineResult result = replay::replay(log, machine, {.observer = &slow_stage, .path = &slow_stage});
  EXPECT_GT(slow_stage.path().nodes[4], result.end - result.end / 50);

  machine.host.occupancy_cycles = 1'000'000;
  PathRecorder slow_host(unlimited);
  const MachineResult waiting = replay::replay(log, machine, {.observer = &slow_host, .path = &slow_host});
  EXPECT_EQ(of(slow_host.path(), PathKind::dispatch),
            machine.host.clock.cycles(machine.host.latency_cycles + 399 * machine.host.occupancy_cycles));
  EXPECT_GT(of(slow_host.path(), PathKind::dispatch), waiting.end - waiting.end / 50);
}

TEST(CriticalPath, OfANetworkThatTakesNoTimeHasNoMessages) {
  for (const std::int64_t hop : {0, 50}) {
    test::Random random(6);
    const WorkLog log = test::random_ray_trees(random, 8, 8, 12, 3);
    MachineConfig machine = pipeline_of_nine();
    machine.network.hop_cycles = hop;
    machine.pipeline.in_flight = 1;  // so that each message is waited for
    PathRecorder recorder(unlimited);
    (void)replay::replay(log, machine, {.observer = &recorder, .path = &recorder});
    EXPECT_EQ(of(recorder.path(), PathKind::network) > 0, hop > 0);
  }
}

// The path as the second models describe theirs.
std::vector<test::NaivePiece> pieces_of(const PathRecorder& recorder) {
  std::vector<test::NaivePiece> path;
  recorder.each_from_the_end(
      [&](const PathPiece& piece) { test::add_piece(path, test::naive_piece(piece)); });
  return path;
}

TEST(CriticalPath, ASecondWayToFindItFindsTheSame) {
  for (std::uint64_t seed = 0; seed < test::cases(120U); ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const WorkLog log = test::small_log(random, 8);
    MachineConfig machine = test::random_machine(random, 8);
    test::make_plain(random, machine);
    PathRecorder recorder(unlimited, PathPieces::no_fold);
    test::NaivePath naive(recorder, machine);
    const MachineResult result = replay::replay(log, machine, {.observer = &naive, .path = &recorder});
    EXPECT_EQ(pieces_of(recorder), naive.path(result.end));
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

// Makes a random machine in which rays move one whose path the second models find: nothing that is shared
// makes anyone wait but queues, credits and the host, and whatever is done takes time.
void make_plain_flow(test::Random& random, MachineConfig& machine) {
  machine.l2.sharing = SecondLevel::none;
  machine.count = {};
  machine.operations = {1, 1, 1, 1, 1, 1, 1, 1};
  machine.messages.send_cycles = test::pick(random, 1, 4);
  machine.messages.receive_cycles = test::pick(random, 1, 4);
  machine.network.kind = memory::NetworkKind::ideal;
  if (machine.cache.cache.replacement == memory::Replacement::random) {
    machine.cache.cache.replacement = memory::Replacement::fifo;  // victims are drawn for each node anew
  }
  if (machine.scheme == Scheme::pipeline) {
    machine.clusters = 1;
    machine.placement = Placement::replicated;
  }
}

TEST(CriticalPath, OfMovingRaysIsThatOfASecondModel) {
  std::int64_t others = 0;
  for (std::uint64_t seed = 0; seed < test::cases(400U); ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    Case c = random_flow(random);
    make_plain_flow(random, c.machine);
    PathRecorder recorder(unlimited, PathPieces::no_fold);
    const MachineResult result = replay::replay(c.log, c.machine, {.observer = &recorder, .path = &recorder});
    if (c.machine.scheme == Scheme::pipeline) {
      const test::NaivePipeline naive(c.log, c.machine);
      ASSERT_EQ(pieces_of(recorder), naive.path.path(result.end));
    } else {
      test::NaiveSpace naive(c.log, c.machine);
      (void)naive.run();
      ASSERT_EQ(pieces_of(recorder), naive.path.path(result.end));
    }
    others += recorder.path().node_changes;
  }
  EXPECT_GT(others, test::cases(1000));
}

TEST(CriticalPath, FoldingPiecesChangesNoSum) {
  for (std::uint64_t seed = 0; seed < test::cases(300U); ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const Case c = seed % 3 == 0 ? random_flow(random) : random_case(random);
    PathRecorder whole(unlimited, PathPieces::no_fold);
    PathRecorder folded(unlimited, static_cast<std::uint32_t>(test::pick(random, 0, 200)));
    (void)replay::replay(c.log, c.machine, {.observer = &whole, .path = &whole});
    (void)replay::replay(c.log, c.machine, {.observer = &folded, .path = &folded});
    const CriticalPath& a = whole.path();
    const CriticalPath& b = folded.path();
    EXPECT_EQ(a.end, b.end);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.pieces, b.pieces);
    EXPECT_EQ(a.node_changes, b.node_changes);
    ASSERT_EQ(a.levels.size(), b.levels.size());
    for (std::size_t level = 0; level < a.levels.size(); ++level) {
      EXPECT_EQ(a.levels[level].traversal, b.levels[level].traversal);
      EXPECT_EQ(a.levels[level].reads, b.levels[level].reads);
    }
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

TEST(CriticalPath, WhatIsKeptDoesNotGrowWithTheFrame) {
  std::vector<MachineConfig> machines;
  for (const memory::InterconnectKind kind :
       {memory::InterconnectKind::ideal, memory::InterconnectKind::bus, memory::InterconnectKind::crossbar}) {
    MachineConfig& machine = machines.emplace_back();
    machine.nodes = 16;
    machine.cache.organisation = CacheOrganisation::none;
    machine.interconnect.kind = kind;
  }
  for (const Scheme scheme : {Scheme::pipeline, Scheme::space}) {
    machines.push_back(pipeline_of_nine());
    machines.back().scheme = scheme;
    machines.back().space.in_flight = 20;
  }
  for (const MachineConfig& machine : machines) {
    const bool image = machine.scheme == Scheme::image;
    const std::uint32_t small = image ? 16 : 32;
    std::uint64_t kept = 0;
    for (const std::uint32_t size : {small, 4 * small}) {
      test::Random random(5);
      const WorkLog log =
          image ? test::random_log(random, size, size) : test::random_ray_trees(random, size, size, 12, 3);
      PathRecorder recorder(unlimited, 1000);
      (void)replay::replay(log, machine, {.observer = &recorder, .path = &recorder});
      EXPECT_TRUE(!image || recorder.path().pieces > 2000);
      kept = recorder.pieces().most_kept() - kept;
    }
    EXPECT_LT(kept, image ? 100U : 200U);
  }
}

TEST(CriticalPath, IsRefusedWhereItDoesNotFitOrIsNotDefined) {
  test::Random random(1);
  const WorkLog log = test::random_log(random, 2, 2);
  MachineConfig machine;
  PathRecorder small(sim::MemoryBudget(1 << 16U, true));
  const auto refusal = [&](PathRecorder& path) {
    return test::user_error_of<sim::KeyError>(
        [&] { (void)replay::replay(log, machine, {.observer = &path, .path = &path}); });
  };
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "record.critical_path", refusal(small));
  // A timeline needs every piece, so leaving it out may be enough.
  PathRecorder unfolded(sim::MemoryBudget(1 << 16U, true), PathPieces::no_fold);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "record.timeline", refusal(unfolded));
  machine.banks.dram.emplace().policy = memory::DramPolicy::frfcfs;
  EXPECT_THROW(check_critical_path(machine), sim::KeyError);
}

}  // namespace
}  // namespace marti::processors
