// SIMT nodes: against a plain second implementation, against closed forms and against scalar nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "processors/program/ray_grid.h"
#include "processors/replay/replay.h"
#include "processors/walk/observer.h"
#include "simt_logs.h"
#include "simt_machines.h"
#include "tests/support/first_difference.h"
#include "tests/support/long_tests.h"
#include "tests/support/naive_simt.h"
#include "tests/support/random_simt.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace program;
using namespace replay;
using walk::SimtCounts;

namespace {

std::int64_t lane_cycles(const SimtCounts& counts) {
  std::int64_t sum = 0;
  for (std::size_t state = 0; state < walk::lane_states; ++state) {
    sum += counts.*SimtCounts::counters()[state].member;
  }
  return sum;
}

std::int64_t all_rays(const StepCounts& steps) {
  std::int64_t rays = 0;
  for (const auto counter : ray_counters) {
    rays += steps.*counter;
  }
  return rays;
}

// Laws that hold for the result of either implementation.
void expect_laws(const WorkLog& log, const MachineConfig& machine, const MachineResult& result) {
  const StepCounts steps = result.steps();
  const LogTotals totals = totals_of(log);
  const auto pixels = static_cast<std::int64_t>(log.width) * log.height;
  ASSERT_EQ(static_cast<std::uint64_t>(all_rays(steps)), totals.all_rays());
  if (result.simt.counts().helps == 0) {  // lanes that help find hits in another order
    ASSERT_EQ(static_cast<std::uint64_t>(steps.branches), totals.branches);
    ASSERT_EQ(static_cast<std::uint64_t>(steps.transforms), totals.transforms);
    ASSERT_EQ(static_cast<std::uint64_t>(steps.leaves), totals.leaves);
    ASSERT_EQ(static_cast<std::uint64_t>(steps.tests), totals.tests);
  }
  ASSERT_EQ(static_cast<std::uint64_t>(steps.shades), totals.shades);
  ASSERT_EQ(static_cast<std::uint64_t>(steps.texels), totals.texels);
  ASSERT_EQ(steps.pixels, machine.pixels == Pixels::written ? pixels : 0);
  std::int64_t packets = 0;
  std::int64_t writes = 0;
  for (std::size_t n = 0; n < result.nodes.size(); ++n) {
    const NodeStatistics& node = result.nodes[n];
    const SimtCounts& counts = result.simt.nodes.at(n);
    ASSERT_EQ(sum_of(node.time), result.end) << "node " << n;
    ASSERT_EQ(node.finish % machine.clock.period(), 0);
    packets += node.packets;
    writes += node.writes;
    const std::int64_t cycles = node.finish / machine.clock.period();
    ASSERT_EQ(lane_cycles(counts) % machine.simt.lanes, 0);
    ASSERT_LE(lane_cycles(counts), cycles * machine.simt.lanes * machine.simt.warps);
    ASSERT_LE(counts.unit_cycles, cycles * machine.rt.warps);
    ASSERT_LE(counts.line_cycles, cycles * machine.simt.mshrs);
    ASSERT_LE(counts.full_cycles, cycles);
    ASSERT_LE(counts.longest_ray, counts.longest_warp);
    ASSERT_LE(counts.accesses, counts.records);
    ASSERT_LE(counts.rays, all_rays(node.steps));
    ASSERT_LE(counts.joined, node.references.all_hits());
    ASSERT_LE(counts.fills, counts.spills);
    ASSERT_TRUE(machine.rt.stack > 0 || counts.spills == 0);
    if (machine.rt.warps == 0) {
      ASSERT_EQ(counts.traces + counts.unit_cycles + counts.lanes_unit + counts.lanes_box, 0);
    }
  }
  ASSERT_EQ(static_cast<std::uint64_t>(packets), result.packets);
  ASSERT_LE(writes, machine.pixels == Pixels::written ? pixels : 0);
  std::int64_t reads = 0;
  std::int64_t written = 0;
  for (const ClusterResult& cluster : result.clusters) {
    reads += cluster.interconnect.reads;
    written += cluster.interconnect.writes;
  }
  ASSERT_EQ(written, writes + result.simt.counts().spills);
  std::int64_t asked = result.references().all_misses() + result.contexts.counts().issued;
  if (machine.l2.sharing == SecondLevel::private_caches) {
    ASSERT_EQ(result.l2.counters().references(), asked);
    asked = result.l2.counters().misses;
  }
  ASSERT_EQ(reads, machine.placement == Placement::replicated ? 0 : asked);
}

TEST(Simt, EqualsTheNaiveOneOnRandomMachines) {
  const std::vector<std::vector<WorkLog>> logs = {test::simt_logs(7, 5), test::simt_logs(16, 12)};
  const std::size_t machines = marti::test::cases(marti::test::stride(200, 4000));
  SimtCounts all;
  walk::ContextCounts prefetches;
  for (std::uint64_t seed = 1; seed <= machines; ++seed) {
    marti::test::Random random(seed);
    const auto& sizes = logs[random() % 12 == 0 ? 1 : 0];
    const std::size_t which = random() % sizes.size();
    const MachineConfig machine = marti::test::random_simt(random, sizes[which]);
    const MachineResult plain = marti::test::naive_simt(sizes[which], machine);
    const std::string about = "seed " + std::to_string(seed) + ", log " + std::to_string(which) + ": " +
                              marti::test::describe_simt(machine);
    SCOPED_TRACE(about);
    expect_laws(sizes[which], machine, plain);
    ASSERT_FALSE(::testing::Test::HasFatalFailure());
    ASSERT_EQ(marti::test::FirstDifference::between(replay::replay(sizes[which], machine), plain), "");
    sim::merge(all, plain.simt.counts());
    sim::merge(prefetches, plain.contexts.counts());
  }
  if (machines < 200) {
    return;  // under the sanitizers, which run a fifth of them
  }
  // These machines meet all that is counted.
  sim::for_each_counter(all, [&](const sim::Counter<SimtCounts>& counter, std::int64_t value) {
    EXPECT_GT(value, 100) << counter.name;
  });
  for (const std::int64_t value :
       {prefetches.useful, prefetches.useless, prefetches.late, prefetches.dropped}) {
    EXPECT_GT(value, 20);
  }
}

// Adds up what is told of lanes.
class LaneListener final : public walk::Observer {
 public:
  void begin(const walk::ReplayInput& input) override { width_ = input.log.width; }
  void spent(std::uint32_t, walk::NodeState, sim::Ticks, sim::Ticks, walk::PixelPlace) override {}
  void missed(std::uint32_t, std::int64_t misses, walk::PixelPlace pixel) override {
    ASSERT_LT(pixel.x, width_);
    missed_ += misses;
  }
  [[nodiscard]] bool hears_lanes() const override { return true; }
  void lane_spent(bool working, sim::Ticks time, walk::PixelPlace pixel) override {
    ASSERT_LT(pixel.x, width_);
    ASSERT_GT(time, 0);
    (working ? worked_ : waited_) += time;
  }
  [[nodiscard]] bool hears_references() const override { return true; }
  void referred(const walk::Request& reference, memory::RecordKind /*kind*/, bool hit) override {
    last_.resize(std::max<std::size_t>(last_.size(), reference.node + 1));
    ASSERT_GE(reference.time, last_[reference.node]);
    last_[reference.node] = reference.time;
    ++(hit ? hits_ : misses_);
  }
  void expect_sums_of(const MachineConfig& machine, const MachineResult& result) const {
    EXPECT_EQ(hits_, result.references().all_hits());
    EXPECT_EQ(misses_, result.references().all_misses());
    const SimtCounts counts = result.simt.counts();
    const sim::Ticks period = machine.clock.period();
    EXPECT_EQ(worked_, period * (counts.lanes_shading + counts.lanes_box + counts.lanes_primitive));
    EXPECT_EQ(waited_, period * (counts.lanes_slot + counts.lanes_unit + counts.lanes_scheduler +
                                 counts.lanes_cache + counts.lanes_memory));
    EXPECT_EQ(missed_, result.references().all_misses());
  }

 private:
  std::uint32_t width_ = 0;
  sim::Ticks worked_ = 0;
  sim::Ticks waited_ = 0;
  std::int64_t missed_ = 0;
  std::int64_t hits_ = 0;
  std::int64_t misses_ = 0;
  std::vector<sim::Ticks> last_;  // of each node
};

TEST(Simt, WhatLanesDoForPixelsAddsUp) {
  const std::vector<WorkLog> logs = test::simt_logs(7, 5);
  for (std::uint64_t seed = 1; seed <= marti::test::cases(marti::test::stride(150, 2000)); ++seed) {
    marti::test::Random random(seed);
    const WorkLog& log = logs[random() % logs.size()];
    const MachineConfig machine = marti::test::random_simt(random, log);
    SCOPED_TRACE(marti::test::describe_simt(machine));
    LaneListener listener;
    ReplayOptions options;
    options.observer = &listener;
    const MachineResult heard = replay::replay(log, machine, options);
    listener.expect_sums_of(machine, heard);
    ASSERT_EQ(marti::test::FirstDifference::between(heard, replay::replay(log, machine)), "");
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

// What the log has beside the visits changes nothing else in it.
TEST(Simt, EnteredChildrenAreBesideTheLog) {
  const std::vector<WorkLog> with = test::simt_logs(7, 5);
  const std::vector<WorkLog> without = test::simt_logs(7, 5, false);
  for (std::size_t i = 0; i < with.size(); ++i) {
    ASSERT_EQ(with[i].has_entered(),
              accel::walks_bvh(with[i].traversal) && with[i].order == accel::WalkOrder::depth_first);
    ASSERT_FALSE(without[i].has_entered());
    ASSERT_TRUE(with[i].has_ray_words());
    ASSERT_FALSE(without[i].has_ray_words());
    for (std::uint32_t y = 0; y < with[i].height; ++y) {
      ASSERT_TRUE(with[i].rows[y].words == without[i].rows[y].words);
      ASSERT_TRUE(with[i].rows[y].begin == without[i].rows[y].begin);
      for (std::uint32_t x = 0; x < with[i].width; ++x) {
        std::size_t rays = 0;
        const std::span<const std::uint32_t> words = with[i].pixel(x, y);
        for (std::size_t at = 0; at < words.size(); at += step_words(&words[at])) {
          rays += step_of(words[at]) == Step::ray ? 1 : 0;
        }
        ASSERT_EQ(with[i].ray_words(x, y).size(), rays);
      }
    }
    MachineConfig machine;
    machine.kind = NodeKind::simt;
    machine.prefetch.stack = 2;
    EXPECT_THROW((void)replay::replay(without[i], machine), sim::UserError);
    machine.prefetch.stack = 0;
    machine.rt.sort = RaySort::origin;
    EXPECT_THROW((void)replay::replay(without[i], machine), sim::UserError);
  }
}

// A law: whatever the order, the image is the same, ray by ray. Breadth first finds its hits late, so it
// visits more nodes.
TEST(Simt, OrdersOfTraversalGiveEqualImages) {
  std::vector<scenes::Scene> scenes;
  scenes.push_back(test::glass_and_pictures());
  for (const std::string_view name : {"jacks:2", "room:2", "balls:2", "teapot:3"}) {
    scenes.push_back(scenes::make_procedural(name));
  }
  for (const scenes::Scene& scene : scenes) {
    for (const accel::BvhNodeKind node : {accel::BvhNodeKind::two, accel::BvhNodeKind::four,
                                          accel::BvhNodeKind::eight, accel::BvhNodeKind::eight_quantised}) {
      for (const Integrator integrator : {Integrator::whitted, Integrator::path}) {
        accel::StructureOptions structure;
        structure.bvh.node = node;
        test::Built built(scene);
        built.structure = accel::make_structure("bvh", built.triangles, structure);
        RenderOptions options{.width = 24, .height = 18, .max_depth = 3, .integrator = integrator};
        options.record = true;
        const Frame usual = built.render(options);
        options.treelet_records = 5;
        for (const accel::WalkOrder order :
             {accel::WalkOrder::breadth_first, accel::WalkOrder::treelet_first}) {
          for (const bool floats : {false, true}) {
            options.floats = floats;
            options.order = accel::WalkOrder::depth_first;
            const Frame expected = floats ? built.render(options) : usual;
            options.order = order;
            const Frame frame = built.render(options);
            ASSERT_EQ(frame.hit_hash, expected.hit_hash);
            ASSERT_EQ(frame.image.pixels, expected.image.pixels);
            ASSERT_EQ(frame.log->order, order);
            const LogTotals now = totals_of(*frame.log);
            const LogTotals before = totals_of(*expected.log);
            ASSERT_EQ(now.all_rays(), before.all_rays());
            ASSERT_TRUE(order != accel::WalkOrder::breadth_first || now.branches >= before.branches);
          }
        }
      }
    }
  }
}

// Its warps write pixels while the node's only line is under way.
TEST(Simt, OnePortWritesWhileItReads) {
  const std::vector<WorkLog> logs = test::simt_logs(7, 5);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    marti::test::Random random(seed);
    const WorkLog& log = logs[random() % logs.size()];
    MachineConfig machine = marti::test::random_simt(random, log);
    machine.clusters = machine.nodes = machine.simt.mshrs = 1;
    machine.simt.warps = 6;
    machine.pixels = Pixels::written;
    machine.placement = Placement::shared;
    machine.interconnect.kind = memory::InterconnectKind::bus;
    machine.interconnect.mode = memory::BusMode::split;
    machine.interconnect.arbitration = memory::Arbitration::fifo;
    if (machine.banks.dram) {
      machine.banks.dram->policy = memory::DramPolicy::frfcfs;
    }
    ASSERT_EQ(marti::test::FirstDifference::between(replay::replay(log, machine),
                                                    marti::test::naive_simt(log, machine)),
              "")
        << "seed " << seed << ": " << marti::test::describe_simt(machine);
  }
}

// ---- closed forms

// A tree of branches only, so many that each of `records` visits has one of its own.
accel::Topology branches(std::uint32_t records) {
  accel::Topology topology;
  topology.nodes.push_back({1, records, 1, false});
  topology.nodes.insert(topology.nodes.end(), records, accel::TopologyNode{0, 1, 2, false});
  return topology;
}

// One row of pixels, each with one ray that visits `records` branches: those of pixel x from first(x) on.
WorkLog row_of(std::uint32_t pixels, std::uint32_t records,
               const std::function<std::uint32_t(std::uint32_t)>& first) {
  WorkLog log;
  log.traversal = accel::Traversal::octree;
  log.width = pixels;
  log.height = 1;
  log.texture_begin = {0};
  log.rows.resize(1);
  std::uint32_t last = 0;
  for (std::uint32_t x = 0; x < pixels; ++x) {
    log.rows[0].begin.push_back(static_cast<std::uint32_t>(log.rows[0].words.size()));
    log.rows[0].words.push_back(camera_ray);
    for (std::uint32_t i = 0; i < records; ++i) {
      log.rows[0].words.push_back(make_word(Step::branch, first(x) + i));
      last = std::max(last, first(x) + i);
    }
  }
  log.rows[0].begin.push_back(static_cast<std::uint32_t>(log.rows[0].words.size()));
  log.topology = branches(last + 1);
  return log;
}

TEST(Simt, LanesThatReadTheSameTakeTheTimeOfOne) {
  for (const std::uint32_t lanes : {1U, 7U, 64U}) {
    for (const std::int64_t hit : {1, 3}) {
      for (const std::int64_t test : {0, 1, 8}) {
        const std::int64_t records = 9;
        const WorkLog log = row_of(lanes, records, [](std::uint32_t) { return 0; });
        const MachineResult result = replay::replay(log, test::one_warp(lanes, hit, test));
        const SimtCounts& counts = result.simt.nodes.at(0);
        EXPECT_EQ(counts.unit_cycles, records * (hit + test));
        EXPECT_EQ(counts.accesses, records);
        EXPECT_EQ(counts.records, records * lanes);
        // It waits one cycle for the unit, and nothing else takes time.
        EXPECT_EQ(counts.longest_ray, records * (hit + test) + 1);
        EXPECT_EQ(result.end, (records * (hit + test) + 1) * 10);
      }
    }
  }
}

TEST(Simt, LanesThatShareNothingTakeTurnsAtTheCache) {
  for (const std::int64_t lanes : {1, 2, 5, 33, 64}) {
    for (const std::int64_t hit : {1, 4}) {
      for (const std::int64_t test : {0, 3, 20}) {
        const std::int64_t records = 6;
        const WorkLog log = row_of(static_cast<std::uint32_t>(lanes), records,
                                   [](std::uint32_t x) { return x * static_cast<std::uint32_t>(records); });
        const MachineResult result =
            replay::replay(log, test::one_warp(static_cast<std::uint32_t>(lanes), hit, test));
        const SimtCounts& counts = result.simt.nodes.at(0);
        EXPECT_EQ(counts.accesses, records * lanes);
        EXPECT_GE(counts.unit_cycles, std::max(lanes * records, records * (hit + test)));
        EXPECT_LE(counts.unit_cycles, lanes * records + records * (hit + test));
      }
    }
  }
}

// A ray that enters both children of `depth` branches, one below the other, and of each first the branch: it
// visits all branches, then all leaves, of one entry each.
WorkLog chain(std::uint32_t depth, RayKind kind) {
  WorkLog log;
  log.traversal = accel::Traversal::bvh_two;
  log.width = log.height = 1;
  log.primitives = 1;
  log.texture_begin = {0};
  log.topology.entries = {0};
  LogRow& row = log.rows.emplace_back();
  row.begin = {0};
  row.entered.begin = {0};
  row.words.push_back(make_word(Step::ray, ray_operand(kind, 0)));
  accel::EnteredChildren both;
  both.add(0);
  both.add(1);
  const auto node = [&](std::uint32_t first, std::uint32_t count, std::uint32_t level, bool leaf) {
    log.topology.nodes.push_back({first, count, static_cast<std::uint8_t>(level), leaf});
  };
  node(1, 2, 1, false);
  for (std::uint32_t level = 1; level <= depth; ++level) {  // its branch comes first, then its leaf
    const std::uint32_t branch = 2 * level - 1;
    node(level < depth ? branch + 2 : 0, level < depth ? 2 : 1, level + 1, level == depth);
    node(0, 1, level + 1, true);
    row.words.push_back(make_word(Step::branch, level == 1 ? 0 : branch - 2));
    row.entered.words.push_back(both.word());
  }
  row.words.push_back(make_word(Step::leaf, 2 * depth - 1));
  for (std::uint32_t level = kind == RayKind::shadow ? 0 : depth; level > 0; --level) {
    row.words.push_back(make_word(Step::leaf, 2 * level));
  }
  row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  row.entered.begin.push_back(depth);
  return log;
}

TEST(Simt, AStackBeyondTheChipIsWrittenOnceAndReadBackOnce) {
  for (const std::int64_t depth : {1, 2, 9, 40}) {
    for (const std::int64_t room : {0, 1, 3, 8, 64}) {
      for (const std::int64_t line : {8, 32, 128}) {
        for (const RayKind kind : {RayKind::camera, RayKind::shadow}) {
          const std::int64_t hit = 3;
          const std::int64_t test = 5;
          MachineConfig machine = test::one_warp(1, hit, test);
          machine.cache.cache.line = static_cast<std::uint32_t>(line);
          machine.layout.node_bytes = machine.layout.primitive_bytes = 8;
          machine.layout.entry_bytes = 4;
          machine.rt.triangle_cycles = test;
          machine.rt.stack = static_cast<std::uint32_t>(room);
          const MachineResult result =
              replay::replay(chain(static_cast<std::uint32_t>(depth), kind), machine);
          const SimtCounts& counts = result.simt.nodes.at(0);
          const bool shadow = kind == RayKind::shadow;
          const std::int64_t leaves = shadow ? 1 : depth + 1;  // each has a list and a triangle
          const std::int64_t spills = room == 0 ? 0 : std::max<std::int64_t>(0, depth - room) / (line / 8);
          const std::int64_t fills = shadow ? 0 : spills;
          SCOPED_TRACE(marti::test::describe_simt(machine));
          EXPECT_EQ(counts.spills, spills);
          EXPECT_EQ(counts.fills, fills);
          EXPECT_EQ(result.clusters.at(0).interconnect.writes, spills);
          EXPECT_EQ(counts.records, depth + 2 * leaves + fills);
          EXPECT_EQ(counts.unit_cycles, (counts.records) * hit + (depth + leaves) * test);
        }
      }
    }
  }
}

// A warp that is alone waits for nobody, and its rays of one kind stay in the order of their pixels.
TEST(Simt, SortingALoneWarpTakesItsCyclesAndOneMore) {
  for (const std::int64_t cycles : {0, 1, 9}) {
    for (const std::uint32_t rays : {7U, 100U}) {
      const std::uint32_t lanes = 7;
      const std::int64_t turns = 3;
      const WorkLog log = row_of(20, 4, [](std::uint32_t x) { return x / 2; });
      MachineConfig machine = test::one_warp(lanes, 2, 5);
      const MachineResult plain = replay::replay(log, machine);
      machine.rt.sort = RaySort::kind;
      machine.rt.sort_rays = rays;
      machine.rt.sort_cycles = cycles;
      const MachineResult sorted = replay::replay(log, machine);
      const SimtCounts& before = plain.simt.nodes.at(0);
      const SimtCounts& now = sorted.simt.nodes.at(0);
      EXPECT_EQ(now.sorted_warps, turns);
      EXPECT_EQ(now.sorted_rays, 20);
      EXPECT_EQ(now.unit_cycles, before.unit_cycles);
      EXPECT_EQ(now.accesses, before.accesses);
      EXPECT_EQ(now.lanes_unit, before.lanes_unit + 20 * (cycles + 1));
      EXPECT_EQ(sorted.end, plain.end + turns * (cycles + 1) * machine.clock.period());
    }
  }
}

// By hand, after docs/internals/rt-unit.md.
TEST(Simt, RaysAreWordsByTheirCells) {
  scenes::Bounds box;
  box.include({0.0, 0.0, 0.0});
  box.include({32.0, 32.0, 32.0});
  const RayGrid grid(box);
  const auto word = [&](const glm::dvec3& origin, const glm::dvec3& direction) {
    return grid.word({origin, direction});
  };
  // Columns 1, 2 and 4 along x, y and z; octant 2, row 2, column 1.
  EXPECT_EQ(word({1.5, 2.5, 4.5}, {1.0, -2.0, 5.0}), (1U + 16U + 256U) * 512U + 2U * 64U + 2U * 8U + 1U);
  EXPECT_EQ(word({-1.0, -1.0, -1.0}, {0.0, 0.0, 1.0}), 0U);
  EXPECT_EQ(word({99.0, 99.0, 99.0}, {-1.0, 0.0, 0.0}), 0x7fffU * 512U + 64U + 7U);
  EXPECT_EQ(word({32.0, 0.0, 0.0}, {0.0, -1.0, -1e-9}), 0x1249U * 512U + 6U * 64U + 7U * 8U);
}

// Rays that visit branches and leaves of one entry, with a surface point now and then.
WorkLog walks(marti::test::Random& random) {
  using marti::test::pick;
  WorkLog log;
  log.traversal = accel::Traversal::octree;
  log.width = 13;
  log.height = 9;
  log.primitives = 40;
  log.materials = 7;
  log.texture_begin = {0};
  log.topology = marti::test::random_topology(random, 20, log.primitives, 1);
  log.rows.resize(log.height);
  const auto word = [&random](Step step, std::int64_t below) {
    return make_word(step, static_cast<std::uint32_t>(pick(random, 0, below - 1)));
  };
  for (LogRow& row : log.rows) {
    for (std::uint32_t x = 0; x < log.width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      for (std::int64_t rays = pick(random, 1, 3); rays > 0; --rays) {
        row.words.push_back(make_word(Step::ray, ray_operand(static_cast<RayKind>(pick(random, 0, 4)), 0)));
        for (std::int64_t visits = pick(random, 0, 12); visits > 0; --visits) {
          const auto node = static_cast<std::uint32_t>(
              pick(random, 0, static_cast<std::int64_t>(log.topology.nodes.size()) - 1));
          row.words.push_back(make_word(log.topology.nodes[node].leaf ? Step::leaf : Step::branch, node));
        }
        if (random() % 2 == 0) {
          row.words.push_back(word(Step::shade, log.materials));
        }
      }
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  return log;
}

// One lane that computes nothing and has one line under way is a scalar node: it waits for each line. All
// times are whole cycles, records lie within lines, and the host takes the pixels. Nodes do not compete: of
// several that ask at one instant, a core that has ended a pixel comes last.
TEST(Simt, OneLaneIsAScalarNode) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    marti::test::Random random(seed);
    const WorkLog log = walks(random);
    MachineConfig machine = marti::test::random_machine(random, 6);
    const std::uint32_t line = 32;
    machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
    machine.pixels = Pixels::collected;
    if (machine.interconnect.kind != memory::InterconnectKind::ideal) {
      machine.nodes = 1;
    }
    machine.layout = {};
    machine.layout.node_bytes = machine.layout.entry_bytes = machine.layout.primitive_bytes =
        machine.layout.quadric_bytes = machine.layout.material_bytes = line;
    machine.cache.cache.line = line;
    machine.cache.cache.size = std::max(1U, machine.cache.cache.ways) * line * (1U << random() % 4);
    machine.cache.split_sizes.fill(machine.cache.cache.size);
    machine.cache.hit_cycles = marti::test::pick(random, 1, 4);
    if (machine.cache.organisation == CacheOrganisation::none) {
      machine.cache.organisation = CacheOrganisation::split;
    }
    if (machine.placement == Placement::distributed) {
      machine.placement = Placement::shared;
    }
    machine.clock = machine.host.clock = machine.interconnect.clock = machine.banks.clock =
        machine.local.clock = sim::Clock::from_period(7);
    machine.interconnect.cycles_per_beat = marti::test::pick(random, 1, 2);
    marti::test::add_random_second_level(random, machine);
    machine.l2.hit_cycles = marti::test::pick(random, 1, 3);
    machine.l2.clock.reset();
    // A memory that takes no time at all is there in the next cycle for one, and at once for the other.
    machine.interconnect.latency_cycles = machine.local.access_cycles = marti::test::pick(random, 1, 12);
    const MachineResult scalar = replay::replay(log, machine);
    machine.kind = NodeKind::simt;
    machine.simt.lanes = machine.simt.warps = machine.simt.mshrs = 1;
    machine.rt.warps = 0;
    const MachineResult one = replay::replay(log, machine);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + marti::test::describe_simt(machine));
    ASSERT_EQ(one.end, scalar.end);
    for (std::size_t n = 0; n < one.nodes.size(); ++n) {
      ASSERT_EQ(one.nodes[n].finish, scalar.nodes[n].finish);
    }
    // The division of time counts a look-up as work of its step.
    MachineResult same = one;
    for (std::size_t n = 0; n < one.nodes.size(); ++n) {
      same.nodes[n].time = scalar.nodes[n].time;
    }
    same.simt = scalar.simt;
    ASSERT_EQ(marti::test::FirstDifference::between(same, scalar), "");
  }
}

// A warp that never waits for a packet is on a node's every cycle.
TEST(Simt, LaneCyclesAddUp) {
  const std::vector<WorkLog> logs = test::simt_logs(7, 5);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    marti::test::Random random(seed);
    const WorkLog& log = logs[random() % logs.size()];
    MachineConfig machine = marti::test::random_simt(random, log);
    machine.simt.warps = 1;
    machine.host.assignment = Assignment::blocks;
    machine.pixels = Pixels::collected;
    const MachineResult result = replay::replay(log, machine);
    for (std::size_t n = 0; n < result.nodes.size(); ++n) {
      ASSERT_EQ(lane_cycles(result.simt.nodes.at(n)) * machine.clock.period(),
                result.nodes[n].finish * machine.simt.lanes)
          << marti::test::describe_simt(machine);
    }
  }
}

TEST(Simt, RefusesWhatCannotBe) {
  struct Case {
    std::string key;
    std::function<void(MachineConfig&)> spoil;
  };
  const std::vector<Case> cases = {
      {"simt.lanes", [](MachineConfig& m) { m.simt.lanes = 0; }},
      {"simt.lanes", [](MachineConfig& m) { m.simt.lanes = most_lanes + 1; }},
      {"simt.warps", [](MachineConfig& m) { m.simt.warps = 0; }},
      {"simt.warps", [](MachineConfig& m) { m.simt.warps = most_warps + 1; }},
      {"simt.issue", [](MachineConfig& m) { m.simt.issue = 0; }},
      {"cache.ports", [](MachineConfig& m) { m.simt.ports = 0; }},
      {"cache.ports", [](MachineConfig& m) { m.simt.ports = most_cache_ports + 1; }},
      {"cache.mshrs", [](MachineConfig& m) { m.simt.mshrs = 0; }},
      {"cache.mshrs", [](MachineConfig& m) { m.simt.mshrs = most_mshrs + 1; }},
      {"cache.mshrs",
       [](MachineConfig& m) {
         m.nodes = most_nodes;
         m.simt.mshrs = most_mshrs;
       }},
      {"rt.warps", [](MachineConfig& m) { m.rt.warps = most_warps + 1; }},
      {"rt.box_units", [](MachineConfig& m) { m.rt.box_units = most_test_units + 1; }},
      {"rt.triangle_units", [](MachineConfig& m) { m.rt.triangle_units = most_test_units + 1; }},
      {"cache.sector", [](MachineConfig& m) { m.simt.sector = 24; }},
      {"cache.sector", [](MachineConfig& m) { m.simt.sector = 2 * m.cache.cache.line; }},
      {"cache.sector",
       [](MachineConfig& m) {
         m.cache.cache.line = 128;
         m.simt.sector = 1;
       }},
      {"node.kind", [](MachineConfig& m) { m.cache.organisation = CacheOrganisation::none; }},
      {"node.contexts", [](MachineConfig& m) { m.contexts = 2; }},
      {"prefetch.stack", [](MachineConfig& m) { m.prefetch.stack = most_prefetched_entries + 1; }},
      {"prefetch.queue", [](MachineConfig& m) { m.prefetch.queue = 0; }},
      {"prefetch.stack",
       [](MachineConfig& m) {
         m.prefetch.stack = 1;
         m.rt.warps = 0;
       }},
      {"prefetch.stack",
       [](MachineConfig& m) {
         m.prefetch.stack = 1;
         m.placement = Placement::replicated;
       }},
      {"prefetch.stack",
       [](MachineConfig& m) {
         m.prefetch.stack = 1;
         m.kind = NodeKind::core;
       }},
      {"prefetch.stack", [](MachineConfig& m) { m.prefetch.stack = 1; }},  // of a log of an octree
      {"rt.sort_rays", [](MachineConfig& m) { m.rt.sort_rays = 0; }},
      {"rt.sort_rays", [](MachineConfig& m) { m.rt.sort_rays = most_sorted_rays + 1; }},
      {"rt.sort_cycles", [](MachineConfig& m) { m.rt.sort_cycles = -1; }},
      {"rt.sort",
       [](MachineConfig& m) {
         m.rt.sort = RaySort::kind;
         m.rt.warps = 0;
       }},
      {"rt.sort",
       [](MachineConfig& m) {
         m.rt.sort = RaySort::kind;
         m.kind = NodeKind::core;
       }},
      {"rt.sort",
       [](MachineConfig& m) { m.rt.sort = RaySort::direction; }},          // of a log without words of rays
      {"rt.share", [](MachineConfig& m) { m.rt.share = RtShare::warp; }},  // of a log without what rays meet
      {"rt.share",
       [](MachineConfig& m) {
         m.rt.share = RtShare::warp;
         m.rt.warps = 0;
       }},
      {"rt.share",
       [](MachineConfig& m) {
         m.rt.share = RtShare::warp;
         m.kind = NodeKind::core;
       }},
      {"rt.stack",
       [](MachineConfig& m) {
         m.rt.share = RtShare::warp;
         m.rt.stack = 2;
       }},
      {"rt.stack", [](MachineConfig& m) { m.rt.stack = most_stack_entries + 1; }},
      {"rt.stack",
       [](MachineConfig& m) {
         m.rt.stack = 1;
         m.rt.warps = 0;
       }},
      {"rt.stack",
       [](MachineConfig& m) {
         m.rt.stack = 1;
         m.placement = Placement::replicated;
       }},
      {"rt.stack",
       [](MachineConfig& m) {
         m.rt.stack = 1;
         m.simt.sector = 4;
       }},
      {"rt.stack",
       [](MachineConfig& m) {
         m.rt.stack = 1;
         m.kind = NodeKind::core;
       }},
      {"rt.stack", [](MachineConfig& m) { m.rt.stack = 1; }},  // of a log of an octree
      {"prefetch.treelet", [](MachineConfig& m) { m.prefetch.treelet = true; }},
      {"rt.scheduler", [](MachineConfig& m) { m.rt.scheduler = RtScheduler::treelet; }},
      {"prefetch",
       [](MachineConfig& m) {
         m.prefetch.next_line = true;
         m.prefetch.outstanding = 1;
       }},
      {"build.sharing", [](MachineConfig& m) { m.build.sharing = Sharing::private_trees; }},
      {"database.placement", [](MachineConfig& m) { m.placement = Placement::distributed; }},
      {"machine.scheme", [](MachineConfig& m) { m.scheme = Scheme::pipeline; }},
  };
  const WorkLog log = row_of(3, 2, [](std::uint32_t) { return 0; });
  for (const Case& each : cases) {
    MachineConfig machine = test::one_warp(4, 1, 1);
    EXPECT_NO_THROW((void)replay::replay(log, machine));
    each.spoil(machine);
    const std::string said = marti::test::user_error_of([&] { (void)replay::replay(log, machine); });
    EXPECT_TRUE(marti::test::says(said, each.key)) << each.key << " is refused with: " << said;
  }
  WorkLog mailed = log;
  mailed.mailboxes = true;
  const std::string said =
      marti::test::user_error_of([&] { (void)replay::replay(mailed, test::one_warp(4, 1, 1)); });
  EXPECT_TRUE(marti::test::says(said, "mailboxes")) << said;
}

}  // namespace
}  // namespace marti::processors
