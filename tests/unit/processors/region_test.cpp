// The regions of the space scheme: cut, dealt out and counted, against brute force and bounds.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "memory/layout.h"
#include "processors/flow/space/region_policy.h"
#include "processors/flow/space/region_work.h"
#include "processors/flow/space/space_plan.h"
#include "sim/error.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace cost;
using namespace flow;
using namespace machine;
using namespace program;

namespace {

// Parents, from the children that branches name.
std::vector<std::uint32_t> parents_of(const accel::Topology& topology) {
  std::vector<std::uint32_t> parents(topology.nodes.size(), RegionMap::top);
  for (std::uint32_t number = 0; number < parents.size(); ++number) {
    for (std::uint32_t child = 0; !topology.nodes[number].leaf && child < topology.nodes[number].count;
         ++child) {
      parents[topology.nodes[number].first + child] = number;
    }
  }
  return parents;
}

RC_GTEST_PROP(Regions, EachTreeNodeIsInOneRegionOrTheTop, (std::uint64_t seed)) {
  test::Random random(seed);
  const accel::Topology topology =
      test::random_topology(random, static_cast<std::uint32_t>(test::pick(random, 0, 20)), 50, 6);
  const auto level = static_cast<std::uint32_t>(test::pick(random, 1, 8));
  const RegionMap map = cut_regions(topology, level);
  const std::vector<std::uint32_t> parents = parents_of(topology);
  RC_ASSERT(std::set<std::uint32_t>(map.roots.begin(), map.roots.end()).size() == map.roots.size());
  std::uint32_t top = 0;
  for (std::uint32_t number = 0; number < topology.nodes.size(); ++number) {
    const accel::TopologyNode& node = topology.nodes[number];
    // Up to the cut.
    std::uint32_t root = number;
    while (topology.nodes[root].level > level) {
      root = parents[root];
    }
    if ((node.level < level && !node.leaf) || (node.level <= level && node.leaf && node.count == 0)) {
      RC_ASSERT(map.region_of[number] == RegionMap::top);
      ++top;
    } else {
      RC_ASSERT(map.region_of[number] < map.size());
      RC_ASSERT(map.roots[map.region_of[number]] == root);
    }
  }
  RC_ASSERT(top == map.top_nodes);
}

TEST(Regions, AnEmptySceneHasNone) {
  accel::Topology topology;
  topology.nodes = {{0, 0, 1, true}};
  const RegionMap map = cut_regions(topology, 1);
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.top_nodes, 1U);
  EXPECT_TRUE(deal_in_blocks(0, 3).empty());
  EXPECT_TRUE(deal_balanced({}, 3).empty());
}

TEST(Regions, AreNumberedDepthFirst) {
  // A root with two branches of two leaves each, and a leaf between them.
  accel::Topology topology;
  topology.entries = {0};
  topology.nodes = {{1, 3, 1, false}, {4, 2, 2, false}, {0, 1, 2, true}, {6, 2, 2, false},
                    {0, 1, 3, true},  {0, 1, 3, true},  {0, 1, 3, true}, {0, 1, 3, true}};
  EXPECT_EQ(cut_regions(topology, 3).roots, (std::vector<std::uint32_t>{4, 5, 2, 6, 7}));
  EXPECT_EQ(cut_regions(topology, 2).roots, (std::vector<std::uint32_t>{1, 2, 3}));
}

TEST(Regions, WhatIsNoTreeIsRefused) {
  accel::Topology topology;
  EXPECT_THROW((void)cut_regions(topology, 2), sim::InternalError);
  topology.nodes = {{0, 0, 1, true}, {0, 0, 1, true}};
  EXPECT_THROW((void)cut_regions(topology, 2), sim::InternalError);
  topology.nodes = {{1, 2, 1, false}, {2, 1, 2, false}, {0, 0, 3, true}};  // two parents
  EXPECT_THROW((void)cut_regions(topology, 2), sim::InternalError);
  topology.nodes = {{0, 1, 1, false}};  // its own child
  EXPECT_THROW((void)cut_regions(topology, 2), sim::InternalError);
  topology.nodes = {{1, 0xffffffffU, 1, false}, {0, 0, 2, true}};
  EXPECT_THROW((void)cut_regions(topology, 2), sim::InternalError);
}

RC_GTEST_PROP(Regions, DistinctPrimitivesAreThoseOfASet, (std::uint64_t seed)) {
  test::Random random(seed);
  const accel::Topology topology =
      test::random_topology(random, static_cast<std::uint32_t>(test::pick(random, 0, 20)), 50, 6);
  const RegionMap map = cut_regions(topology, static_cast<std::uint32_t>(test::pick(random, 1, 6)));
  std::vector<std::set<std::uint32_t>> sets(map.size());
  for (std::size_t number = 0; number < topology.nodes.size(); ++number) {
    if (topology.nodes[number].leaf && topology.nodes[number].count > 0) {
      const auto first = topology.entries.begin() + topology.nodes[number].first;
      sets[map.region_of[number]].insert(first, first + topology.nodes[number].count);
    }
  }
  const std::vector<std::uint64_t> counts = distinct_primitives(topology, map.region_of, map.size(), 50);
  for (std::size_t region = 0; region < sets.size(); ++region) {
    RC_ASSERT(counts[region] == sets[region].size());
  }
}

std::vector<std::uint64_t> sums(std::span<const std::uint64_t> weights,
                                const std::vector<std::uint32_t>& part_of, std::uint32_t parts) {
  std::vector<std::uint64_t> sum(parts, 0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum.at(part_of[i]) += weights[i];
  }
  return sum;
}

// The least possible weight of the heaviest part, over all divisions.
std::uint64_t best_division(std::span<const std::uint64_t> weights, std::vector<std::uint64_t>& loads,
                            std::size_t next) {
  if (next == weights.size()) {
    return *std::max_element(loads.begin(), loads.end());
  }
  std::uint64_t best = ~std::uint64_t{0};
  for (std::uint64_t& load : loads) {
    load += weights[next];
    best = std::min(best, best_division(weights, loads, next + 1));
    load -= weights[next];
  }
  return best;
}

RC_GTEST_PROP(RegionPolicy, BalancedKeepsGrahamsBound, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto parts = static_cast<std::uint32_t>(test::pick(random, 1, 3));
  std::vector<std::uint64_t> weights(static_cast<std::size_t>(test::pick(random, 1, 8)));
  for (std::uint64_t& weight : weights) {
    weight = static_cast<std::uint64_t>(test::pick(random, 0, 30));
  }
  const std::vector<std::uint64_t> dealt = sums(weights, deal_balanced(weights, parts), parts);
  std::vector<std::uint64_t> loads(parts, 0);
  const std::uint64_t best = best_division(weights, loads, 0);
  RC_ASSERT(*std::max_element(dealt.begin(), dealt.end()) * 3 * parts <= (4 * parts - 1) * best);
}

TEST(RegionPolicy, RegionsWithoutWeightAreSpread) {
  const std::vector<std::uint64_t> weights = {0, 9, 0, 0, 8, 0, 0, 0};
  const std::vector<std::uint32_t> part_of = deal_balanced(weights, 4);
  std::vector<int> regions(4, 0);
  for (const std::uint32_t part : part_of) {
    ++regions[part];
  }
  EXPECT_EQ(regions, (std::vector<int>{2, 2, 2, 2}));
  EXPECT_NE(part_of[1], part_of[4]);
}

RC_GTEST_PROP(RegionPolicy, BlocksAreRunsOfEqualNumber, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto regions = static_cast<std::uint32_t>(test::pick(random, 1, 60));
  const auto parts = static_cast<std::uint32_t>(test::pick(random, 1, 60));
  const std::vector<std::uint32_t> blocks = deal_in_blocks(regions, parts);
  RC_ASSERT(std::is_sorted(blocks.begin(), blocks.end()));
  const std::vector<std::uint32_t> scattered = deal_scattered(regions, parts);
  for (const std::vector<std::uint32_t>* part_of : {&blocks, &scattered}) {
    for (std::uint32_t part = 0; part < parts; ++part) {
      const auto held = static_cast<std::uint32_t>(std::count(part_of->begin(), part_of->end(), part));
      RC_ASSERT(held == regions / parts || held == regions / parts + 1);
    }
  }
  for (std::uint32_t region = 0; region < regions; ++region) {
    RC_ASSERT(scattered[region] == region % parts);
  }
}

RC_GTEST_PROP(RegionWork, OfEveryPixelIsTheComputingOfTheLog, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 7, 5);
  const StepTicks ticks = step_ticks(test::random_machine(random), log);
  // One region holds all: every ray of these logs that visits a node is in it.
  const RegionWork work = sample_work(log, cut_regions(log.topology, 1), ticks, 1);
  const LogTotals totals = totals_of(log);
  const auto n = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
  StepTicks flat = ticks;
  flat.sphere_test = flat.cone_test = flat.test;
  sim::Ticks sum = flat.branch * n(totals.branches) + flat.leaf * n(totals.leaves) +
                   flat.lookup * n(totals.lookups) + flat.test * n(totals.tests) +
                   flat.shade * n(totals.shades) + flat.light * n(totals.lights) +
                   flat.texel * n(totals.texels) + flat.any_hit * n(totals.any_hits) +
                   flat.cut * n(totals.cuts) + flat.pass * n(totals.passes);
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    sum += flat.ray[kind] * n(totals.rays[kind]);
  }
  const RegionWork same_tests = sample_work(log, cut_regions(log.topology, 1), flat, 1);
  RC_ASSERT(same_tests.total == sum);
  RC_ASSERT(work.of[0] <= static_cast<std::uint64_t>(work.total));
  // The parts add up to the whole, however it is cut.
  for (std::uint32_t level = 2; level < 6; ++level) {
    const RegionWork cut = sample_work(log, cut_regions(log.topology, level), ticks, 1);
    RC_ASSERT(cut.total == work.total);
    RC_ASSERT(std::accumulate(cut.of.begin(), cut.of.end(), std::uint64_t{0}) <= work.of[0]);
  }
}

TEST(RegionWork, FollowsARayFromRegionToRegion) {
  WorkLog log;
  log.width = 3;
  log.height = 1;
  log.primitives = 1;
  log.materials = 1;
  log.topology.nodes = {{1, 2, 1, false}, {0, 1, 2, true}, {1, 1, 2, true}};
  log.topology.entries = {0, 0};
  const auto ray = [](RayKind kind, std::uint32_t bounce) {
    return make_word(Step::ray, ray_operand(kind, bounce));
  };
  // Pixel 0: the camera ray reads the top and leaf 2, then hits in leaf 1; its shadow ray ends in leaf 2.
  // Pixel 1 is left out by a step of 2; pixel 2 sees only the top.
  log.rows = {{{{ray(RayKind::camera, 0), make_word(Step::branch, 0), make_word(Step::leaf, 2),
                 make_word(Step::leaf, 1), make_word(Step::shade, 0), ray(RayKind::shadow, 1),
                 make_word(Step::branch, 0), make_word(Step::leaf, 2), make_word(Step::light, 0),
                 ray(RayKind::camera, 0), make_word(Step::leaf, 1), ray(RayKind::camera, 0),
                 make_word(Step::branch, 0)},
                {0, 9, 11, 13}},
               {},
               {},
               {}}};
  StepTicks ticks;
  ticks.ray = {1, 2, 3, 4};
  ticks.branch = 10;
  ticks.leaf = 100;
  ticks.test = 1000;
  ticks.shade = 10000;
  ticks.light = 100000;
  const RegionWork work = sample_work(log, cut_regions(log.topology, 2), ticks, 2);
  EXPECT_EQ(work.of,
            (std::vector<std::uint64_t>{100 + 1000 + 10000 + 2 + 10, 1 + 10 + 2 * (100 + 1000) + 100000}));
  EXPECT_EQ(work.total, sim::Ticks{11112 + 102211 + 1 + 10});
}

RC_GTEST_PROP(SpacePlan, MemoryIsThatOfBruteForce, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 5, 4);
  MachineConfig machine = test::random_machine(random);
  machine.nodes = static_cast<std::uint32_t>(test::pick(random, 1, 9));
  machine.space.policy = static_cast<RegionPolicy>(test::pick(random, 0, 3));
  machine.space.level = static_cast<std::uint32_t>(test::pick(random, 1, 6));
  machine.space.sample_step = static_cast<std::uint32_t>(test::pick(random, 1, 6));
  machine.layout.record_alignment = 1U << test::pick(random, 0, 4);
  const memory::RecordCounts counts = {
      log.topology.nodes.size(), 0, log.topology.entries.size(), log.primitives, log.materials,
      log.texture_begin.back(),  20};
  const memory::Layout layout(machine.layout, counts, log.quadrics.size());
  const SpacePlan plan = plan_space(log, machine, layout);
  const auto padded = [&](std::uint64_t bytes) {
    return (bytes + machine.layout.record_alignment - 1) / machine.layout.record_alignment *
           machine.layout.record_alignment;
  };
  std::set<std::uint32_t> anybody;
  std::size_t copies = 0;
  for (std::uint32_t node = 0; node < machine.nodes; ++node) {
    std::uint64_t bytes = log.materials * padded(machine.layout.material_bytes) +
                          log.texture_begin.back() * machine.layout.texel_bytes;
    std::set<std::uint32_t> primitives;
    for (std::size_t number = 0; number < log.topology.nodes.size(); ++number) {
      const accel::TopologyNode& record = log.topology.nodes[number];
      const bool in_top = record.leaf ? record.level <= machine.space.level && record.count == 0
                                      : record.level < machine.space.level;
      RC_ASSERT(in_top == (plan.owner[number] == RegionMap::top));
      const bool no_record = record.leaf && accel::walks_bvh(log.traversal);
      if (!no_record && (in_top || plan.owner[number] == node)) {
        bytes += padded(machine.layout.node_bytes);
      }
      if (plan.owner[number] == node && record.leaf) {
        bytes += std::uint64_t{record.count} * machine.layout.entry_bytes;
        const auto first = log.topology.entries.begin() + record.first;
        primitives.insert(first, first + record.count);
      }
    }
    for (const std::uint32_t primitive : primitives) {
      bytes +=
          padded(log.kind_of(primitive) == accel::PrimitiveKind::triangle ? machine.layout.primitive_bytes
                                                                          : machine.layout.quadric_bytes);
    }
    RC_ASSERT(plan.memory_bytes[node] == bytes);
    copies += primitives.size();
    anybody.insert(primitives.begin(), primitives.end());
  }
  RC_ASSERT(plan.duplicated_primitives == copies - anybody.size());
}

}  // namespace
}  // namespace marti::processors
