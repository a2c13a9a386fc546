// The work log's own rules: what the recorder writes, what the totals count, what the checker of the tests
// refuses.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "processors/program/log_rules.h"
#include "processors/program/recorder.h"
#include "processors/program/work_log.h"
#include "sim/error.h"

namespace marti::processors {

using namespace program;

namespace {

/// A root branch with a leaf of three entries and an empty leaf; one pixel.
WorkLog small_log(const std::vector<std::uint32_t>& words) {
  WorkLog log;
  log.width = 1;
  log.height = 1;
  log.topology.nodes = {{1, 2, 1, false}, {0, 3, 2, true}, {3, 0, 2, true}};
  log.topology.entries = {0, 1, 2};
  log.primitives = 3;
  log.materials = 2;
  log.lights = 1;
  log.texture_begin = {0, 4};
  const auto end = static_cast<std::uint32_t>(words.size());
  log.rows.push_back({{{words.begin(), words.end()}, {0, end}}, {}, {}, {}});
  return log;
}

TEST(WorkLog, CountsEveryKindOfStep) {
  const WorkLog log =
      small_log({make_word(Step::ray, 0), make_word(Step::branch, 0), make_word(Step::leaf, 1),
                 make_word(Step::leaf, 2), make_word(Step::shade, 1), make_word(Step::texel, 0), 3,
                 make_word(Step::ray, ray_operand(RayKind::shadow, 1)), make_word(Step::partial_leaf, 1), 2,
                 make_word(Step::light, 0)});
  EXPECT_EQ(program::fault_of(log), "");
  std::vector<std::uint64_t> shades;
  const LogTotals totals = totals_of(log, &shades);
  EXPECT_EQ(shades, (std::vector<std::uint64_t>{0, 1}));
  EXPECT_EQ(totals.rays[0], 1U);
  EXPECT_EQ(totals.rays[1], 1U);
  EXPECT_EQ(totals.branches, 1U);
  EXPECT_EQ(totals.leaves, 3U);
  EXPECT_EQ(totals.tests, 5U);
  EXPECT_EQ(totals.shades, 1U);
  EXPECT_EQ(totals.lights, 1U);
  EXPECT_EQ(totals.texels, 1U);
  EXPECT_EQ(totals.bytes, 4U * (11 + 2));
  EXPECT_EQ(totals.all_steps(), 14U);
  EXPECT_EQ(totals.visits_95, 3U);
  EXPECT_EQ(totals.most_visits, 3U);
}

// Of 40 rays, each of which visits a node more than the one before, two visit more than 37.
TEST(WorkLog, CountsRaysByTheirVisits) {
  std::vector<std::uint32_t> words;
  for (std::uint32_t ray = 0; ray < 40; ++ray) {
    words.push_back(make_word(Step::ray, 0));
    words.insert(words.end(), ray, make_word(ray % 2 == 0 ? Step::branch : Step::leaf, ray % 2));
    words.push_back(make_word(Step::shade, 1));
  }
  const LogTotals totals = totals_of(small_log(std::move(words)));
  EXPECT_EQ(totals.visits_95, 37U);
  EXPECT_EQ(totals.most_visits, 39U);
  EXPECT_EQ(totals_of(small_log({})).visits_95, 0U);
}

TEST(WorkLog, CountsWhatMailboxesLeftOut) {
  WorkLog log = small_log({make_word(Step::ray, 0), make_word(Step::leaf, 1), make_word(Step::mailed_leaf, 1),
                           3, 0b101, make_word(Step::leaf, 2), make_word(Step::partial_leaf, 1), 1,
                           make_word(Step::mailed_leaf, 1), 2, 0});
  log.mailboxes = true;
  EXPECT_EQ(program::fault_of(log), "");
  const LogTotals totals = totals_of(log);
  EXPECT_EQ(totals.leaves, 5U);
  EXPECT_EQ(totals.tests, 3U + 2 + 0 + 1 + 0);
  EXPECT_EQ(totals.lookups, 3U + 3 + 0 + 1 + 2);
}

// The checker of the tests finds each way in which words can be wrong.
TEST(WorkLog, EveryFaultIsFound) {
  const auto log_of = [](std::vector<std::uint32_t> words, bool mailboxes = true) {
    WorkLog log = small_log(std::move(words));
    log.mailboxes = mailboxes;
    log.materials = 3;
    log.voxels = 1;
    return log;
  };
  EXPECT_EQ(program::fault_of(log_of({make_word(Step::cut, 0), make_word(Step::shade, 2)})), "");
  EXPECT_EQ(program::fault_of(log_of({make_word(Step::pass, 2), make_word(Step::leaf, 1)})), "");
  const std::vector<std::vector<std::uint32_t>> bad = {
      {make_word(Step::branch, 3)},              // no such node
      {make_word(Step::branch, 1)},              // a leaf
      {make_word(Step::leaf, 0)},                // a branch
      {make_word(Step::partial_leaf, 1), 3},     // not partial
      {make_word(Step::partial_leaf, 1)},        // half a step
      {make_word(Step::mailed_leaf, 1)},         // half a step
      {make_word(Step::mailed_leaf, 1), 3},      // no bits
      {make_word(Step::mailed_leaf, 1), 3, 7},   // nothing left out
      {make_word(Step::mailed_leaf, 1), 3, 9},   // a bit too many
      {make_word(Step::mailed_leaf, 1), 4, 1},   // more than the leaf has
      {make_word(Step::mailed_leaf, 0), 1, 0},   // a branch
      {make_word(Step::mailed_leaf, 1), 33, 1},  // half the bits
      {make_word(Step::mailed_leaf, 9), 1, 0},   // no such node
      {make_word(Step::shade, 3)},
      {make_word(Step::light, 1)},
      {make_word(Step::texel, 1), 0},
      {make_word(Step::texel, 0), 4},
      {0xf0000000U},                                         // no such step
      {make_word(Step::cut, 3), make_word(Step::shade, 2)},  // no such node
      {make_word(Step::cut, 2), make_word(Step::shade, 2)},  // an empty leaf
      {make_word(Step::cut, 0), make_word(Step::shade, 0)},  // not averaged
      {make_word(Step::cut, 0)},
      {make_word(Step::cut, 0), make_word(Step::branch, 0)},
      {make_word(Step::shade, 2)},  // averaged, without a cut
      {make_word(Step::pass, 0), make_word(Step::branch, 0)},
      {make_word(Step::pass, 2)},
      {make_word(Step::pass, 2), make_word(Step::shade, 0)},
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_NE(program::fault_of(log_of(bad[i])), "") << i;
  }
  EXPECT_NE(program::fault_of(log_of({make_word(Step::mailed_leaf, 1), 3, 5}, false)), "");
  for (const auto& spoil :
       {+[](WorkLog& log) {
          log.rows[0].begin = {0, 2};
        },
        +[](WorkLog& log) {
          log.rows[0].begin = {1, 1};
        },
        +[](WorkLog& log) { log.rows[0].begin = {0}; }, +[](WorkLog& log) { log.rows.clear(); },
        +[](WorkLog& log) { log.topology.entries[1] = 3; },
        +[](WorkLog& log) { log.topology.nodes[2].first = 4; }, +[](WorkLog& log) { log.samples = 0; },
        +[](WorkLog& log) { log.samples = 2; }}) {
    WorkLog log = log_of({camera_ray});
    EXPECT_EQ(program::fault_of(log), "");
    spoil(log);
    EXPECT_NE(program::fault_of(log), "");
  }
}

TEST(WorkLog, CapacityEndsAtTwentyEightBits) {
  constexpr std::size_t most = std::size_t{1} << 28U;
  EXPECT_NO_THROW(check_log_capacity(most, most, most, most));
  EXPECT_THROW(check_log_capacity(most + 1, 1, 1, 1), sim::UserError);
  EXPECT_THROW(check_log_capacity(1, most + 1, 1, 1), sim::UserError);
  EXPECT_THROW(check_log_capacity(1, 1, most + 1, 1), sim::UserError);
  EXPECT_THROW(check_log_capacity(1, 1, 1, most + 1), sim::UserError);
}

// The log holds what was recorded word for word and pixel for pixel, row after row from the same recorder.
RC_GTEST_PROP(RowRecorder, WritesWhatItIsTold, ()) {
  RowRecorder recorder;
  const auto rows = *rc::gen::inRange(1, 4);
  for (int row = 0; row < rows; ++row) {
    const auto width = *rc::gen::inRange(1U, 6U);
    std::vector<std::uint32_t> words;
    std::vector<std::uint32_t> begin;
    recorder.begin_row(width);
    for (std::uint32_t x = 0; x < width; ++x) {
      recorder.begin_pixel();
      begin.push_back(static_cast<std::uint32_t>(words.size()));
      // Long pixels now and then, so that the buffer grows in the middle of a row.
      const auto steps = *rc::gen::weightedElement<std::uint32_t>({{6, 3}, {2, 1000}, {1, 90000}});
      for (std::uint32_t i = 0; i < steps; ++i) {
        switch (i % 7) {
          case 0:
            recorder.ray(RayKind::reflection, i, {});
            words.push_back(make_word(Step::ray, ray_operand(RayKind::reflection, i)));
            break;
          case 1:
            recorder.branch(i);
            words.push_back(make_word(Step::branch, i));
            break;
          case 2:
            recorder.leaf(i, 5, 5);
            words.push_back(make_word(Step::leaf, i));
            break;
          case 3:
            recorder.leaf(i, 4, 5);
            words.insert(words.end(), {make_word(Step::partial_leaf, i), 4});
            break;
          case 4:
            recorder.shade(i);
            words.push_back(make_word(Step::shade, i));
            break;
          case 5:
            recorder.texel(i, i + 1);
            words.insert(words.end(), {make_word(Step::texel, i), i + 1});
            break;
          default:
            recorder.light(i);
            words.push_back(make_word(Step::light, i));
        }
      }
    }
    begin.push_back(static_cast<std::uint32_t>(words.size()));
    LogRow result;
    recorder.end_row(result);
    RC_ASSERT(std::ranges::equal(result.words, words));
    RC_ASSERT(std::ranges::equal(result.begin, begin));
  }
}

}  // namespace
}  // namespace marti::processors
