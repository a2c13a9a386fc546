// SIMT nodes whose lanes help each other: what rays meet, against the visits of the log, and closed forms.
// simt_test.cpp compares them with a second implementation.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "processors/replay/replay.h"
#include "scenes/procedural.h"
#include "simt_logs.h"
#include "simt_machines.h"
#include "tests/support/naive_share.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace program;

namespace {

// What a lane that nobody helps reads for a ray.
marti::test::NaiveRay alone(const WorkLog& log, const marti::test::NaiveSimtLog& simt,
                            const std::shared_ptr<marti::test::NaiveSharedRay>& ray) {
  marti::test::NaiveRay reads;
  if (ray->meets.size() > 1) {
    marti::test::NaiveSharedLane lane(ray, {0, 0, 1});
    while (std::optional<marti::test::NaiveVisit> visit = lane.next(log, simt)) {
      reads.visits.push_back(std::move(*visit));
    }
  }
  return reads;
}

void expect_visits_of_the_log(const WorkLog& log) {
  ASSERT_TRUE(log.has_meets());
  MachineConfig machine;
  machine.kind = NodeKind::simt;
  if (log.order == accel::WalkOrder::treelet_first) {
    machine.layout.node_order = memory::NodeOrder::treelets;
    machine.layout.treelet_bytes =
        static_cast<std::uint32_t>(log.treelet_records * machine.layout.node_stride());
  }
  std::optional<walk::TreePlan> none;
  const memory::Layout layout = walk::layout_of(log, machine, none);
  const marti::test::NaiveSimtLog simt(log, machine, layout);
  std::size_t rays = 0;
  for (std::uint32_t y = 0; y < log.height; ++y) {
    for (std::uint32_t x = 0; x < log.width; ++x) {
      const std::span<const std::uint32_t> words = log.pixel(x, y);
      std::span<const std::uint32_t> meets = log.meets(x, y);
      std::span<const std::uint32_t> entered;
      for (std::size_t at = 0; at < words.size();) {
        const std::uint32_t word = words[at];
        at += step_words(&words[at]);
        if (step_of(word) != Step::ray) {
          continue;
        }
        ++rays;
        const auto ray = std::make_shared<marti::test::NaiveSharedRay>();
        ray->meets = meets.first(meets.front());
        ray->shadow = ray_kind_of(operand_of(word)) == RayKind::shadow;
        meets = meets.subspan(ray->meets.size());
        StepCounts of_log;
        std::optional<marti::test::NaiveOnWay> way;
        const auto logged = simt.visits(ray_kind_of(operand_of(word)), words, at, of_log, entered, 0, way);
        const auto found = alone(log, simt, ray);
        StepCounts of_walk;
        ASSERT_EQ(found.visits.size(), logged.visits.size()) << "ray " << rays;
        for (std::size_t i = 0; i < found.visits.size(); ++i) {
          ASSERT_EQ(found.visits[i].record->address, logged.visits[i].record->address);
          ASSERT_EQ(found.visits[i].record->bytes, logged.visits[i].record->bytes);
          sim::merge(of_walk, found.visits[i].steps);
        }
        sim::for_each_counter(of_walk, [&](const sim::Counter<StepCounts>& counter, std::int64_t value) {
          ASSERT_EQ(value, of_log.*counter.member) << counter.name;
        });
      }
      ASSERT_TRUE(meets.empty());
    }
  }
  ASSERT_GT(rays, 0U);
}

// What a ray meets is all that timing needs: a lane that nobody helps finds in it, hit by hit, the visits of
// the log, in each order, near and far away, in doubles and in floats.
TEST(SimtShare, WhatRaysMeetHasTheVisitsOfTheLog) {
  std::vector<scenes::Scene> scenes = {test::glass_and_pictures(), scenes::make_procedural("jacks:2"),
                                       scenes::make_procedural("balls:2"), scenes::make_procedural("room:2")};
  scenes.push_back(scenes::make_procedural("teapot:2"));
  scenes::Camera& camera = scenes.back().camera;
  camera.eye = camera.at + 1e7 * (camera.eye - camera.at);  // boxes are tested as for rays from far away
  camera.vertical_fov = 1e-7;
  for (const scenes::Scene& scene : scenes) {
    for (const accel::BvhNodeKind node :
         {accel::BvhNodeKind::two, accel::BvhNodeKind::six, accel::BvhNodeKind::eight_quantised}) {
      test::Built built(scene);
      accel::StructureOptions structure;
      structure.bvh.node = node;
      built.structure = accel::make_structure("bvh", built.triangles, structure);
      for (const accel::WalkOrder order : {accel::WalkOrder::depth_first, accel::WalkOrder::breadth_first,
                                           accel::WalkOrder::treelet_first}) {
        for (const bool floats : {false, true}) {
          RenderOptions options{.width = 12, .height = 9, .max_depth = 3, .floats = floats, .order = order};
          options.treelet_records = order == accel::WalkOrder::treelet_first ? 6 : 0;
          options.integrator = floats ? Integrator::path : Integrator::whitted;
          options.record = options.meets = true;
          expect_visits_of_the_log(*built.render(options).log);
          ASSERT_FALSE(::testing::Test::HasFatalFailure());
        }
      }
    }
  }
}

// A frame that is continued, and one of many threads, have the same words.
TEST(SimtShare, WhatRaysMeetIsTakenOver) {
  test::Built built(test::glass_and_pictures(), "bvh");
  RenderOptions options{.width = 9, .height = 7, .max_depth = 3};
  options.record = options.meets = true;
  const Frame whole = built.render(options);
  PixelSet odd(options.width, options.height);
  PixelSet even(options.width, options.height);
  for (std::uint32_t pixel = 0; pixel < options.width * options.height; ++pixel) {
    (pixel % 2 == 0 ? even : odd).add(pixel % options.width, pixel / options.width);
  }
  options.only = &odd;
  const Frame half = built.render(options);
  options.only = &even;
  options.before = &half;
  const Frame both = built.render(options, 4);
  for (std::uint32_t y = 0; y < options.height; ++y) {
    ASSERT_TRUE(both.log->rows[y].meets.words == whole.log->rows[y].meets.words);
    ASSERT_TRUE(both.log->rows[y].meets.begin == whole.log->rows[y].meets.begin);
  }
}

// A ray that meets the root's `leaves` leaves, of one primitive each, and hits none.
WorkLog fan(std::uint32_t leaves) {
  WorkLog log;
  log.traversal = accel::Traversal::bvh_eight;
  log.width = log.height = 1;
  log.primitives = leaves;
  log.texture_begin = {0};
  log.topology.nodes = {{1, leaves, 1, false}};
  accel::EnteredChildren met;
  LogRow& row = log.rows.emplace_back();
  row.words = {make_word(Step::ray, 0), make_word(Step::branch, 0)};
  row.meets.words.resize(2 + 2 * leaves);
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
    log.topology.nodes.push_back({leaf, 1, 2, true});
    log.topology.entries.push_back(leaf);
    row.words.push_back(make_word(Step::leaf, 1 + leaf));
    met.add(leaf);
    row.meets.words[2 + 2 * leaf] = leaf;
    row.meets.words[3 + 2 * leaf] = static_cast<std::uint32_t>(row.meets.words.size());
    row.meets.words.push_back(0);
  }
  row.meets.words[0] = static_cast<std::uint32_t>(row.meets.words.size());
  row.meets.words[1] = met.word();
  row.begin = {0, static_cast<std::uint32_t>(row.words.size())};
  row.meets.begin = {0, row.meets.words[0]};
  return log;
}

// The ray's lane takes a leaf, and in each cycle another lane takes one of those that wait, until one waits:
// that comes after the first. The last lane to begin, or the ray's own, ends the ray.
TEST(SimtShare, LanesTakeAllLeavesButOneOfAFan) {
  for (const std::uint32_t leaves : {1U, 2U, 3U, 5U, 8U}) {
    for (const std::int64_t hit : {1, 4}) {
      for (const std::int64_t test : {1, 3, 20}) {
        MachineConfig machine = test::one_warp(8, hit, test);
        machine.rt.triangle_cycles = test;
        machine.layout.leaf = memory::LeafLayout::inline_records;
        machine.layout.primitive_bytes = machine.cache.cache.line;
        const WorkLog log = fan(leaves);
        const std::int64_t each = hit + test;
        EXPECT_EQ(replay::replay(log, machine).simt.nodes.at(0).unit_cycles, (1 + leaves) * each);
        machine.rt.share = RtShare::warp;
        const walk::SimtCounts counts = replay::replay(log, machine).simt.nodes.at(0);
        const std::int64_t helpers = std::max<std::int64_t>(0, std::int64_t{leaves} - 2);
        // A lane that helps in the cycle in which the branch was tested is looked up after the ray's own.
        const std::int64_t own = (leaves > 1 ? 2 : 1) * each;
        const std::int64_t last = helpers == 0 ? 0 : helpers + each;
        SCOPED_TRACE(std::to_string(leaves) + " leaves, " + std::to_string(hit) + " and " +
                     std::to_string(test) + " cycles");
        if (each >
            helpers) {  // else the ray's lane is ready for another leaf before the others have taken theirs
          EXPECT_EQ(counts.helps, helpers);
          EXPECT_EQ(counts.unit_cycles, each + std::max(own, last));
        }
        EXPECT_EQ(counts.records, 1 + leaves);
        EXPECT_EQ(counts.rays, 1);
      }
    }
  }
}

}  // namespace
}  // namespace marti::processors
