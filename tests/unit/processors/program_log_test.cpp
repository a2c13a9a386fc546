// The work log's own rules: what the recorder writes, what the totals count, what validate refuses.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "processors/program/recorder.h"
#include "processors/program/work_log.h"
#include "sim/error.h"

namespace marti::processors {
namespace {

/// A root branch with a leaf of three entries and an empty leaf; one pixel.
WorkLog small_log(std::vector<std::uint32_t> words) {
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
  log.rows.push_back({std::move(words), {0, end}});
  return log;
}

TEST(WorkLog, CountsEveryKindOfStep) {
  const WorkLog log = small_log(
      {make_word(Step::ray, 0), make_word(Step::branch, 0), make_word(Step::leaf, 1),
       make_word(Step::leaf, 2), make_word(Step::shade, 1), make_word(Step::texel, 0), 3,
       make_word(Step::ray, 1U | 1U << 2U), make_word(Step::partial_leaf, 1), 2, make_word(Step::light, 0)});
  EXPECT_NO_THROW(validate(log));
  const LogTotals totals = totals_of(log);
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
}

TEST(WorkLog, CountsWhatMailboxesLeftOut) {
  WorkLog log = small_log({make_word(Step::ray, 0), make_word(Step::leaf, 1), make_word(Step::mailed_leaf, 1),
                           3, 0b101, make_word(Step::leaf, 2), make_word(Step::partial_leaf, 1), 1,
                           make_word(Step::mailed_leaf, 1), 2, 0});
  EXPECT_THROW(validate(log), sim::InternalError) << "without mailboxes";
  log.mailboxes = true;
  EXPECT_NO_THROW(validate(log));
  const LogTotals totals = totals_of(log);
  EXPECT_EQ(totals.leaves, 5U);
  EXPECT_EQ(totals.tests, 3U + 2 + 0 + 1 + 0);
  EXPECT_EQ(totals.lookups, 3U + 3 + 0 + 1 + 2);
  for (const std::vector<std::uint32_t>& words : std::vector<std::vector<std::uint32_t>>{
           {make_word(Step::mailed_leaf, 1)},           // half a step
           {make_word(Step::mailed_leaf, 1), 3},        // no bits
           {make_word(Step::mailed_leaf, 1), 3, 7},     // nothing left out
           {make_word(Step::mailed_leaf, 1), 3, 9},     // a bit too many
           {make_word(Step::mailed_leaf, 1), 4, 1},     // more than the leaf has
           {make_word(Step::mailed_leaf, 0), 1, 0},     // a branch
           {make_word(Step::mailed_leaf, 1), 33, 1},    // half the bits
           {make_word(Step::mailed_leaf, 9), 1, 0}}) {  // no such node
    WorkLog bad = small_log(words);
    bad.mailboxes = true;
    EXPECT_THROW(validate(bad), sim::InternalError);
  }
}

TEST(WorkLog, RefusesOperandsThatNameNothing) {
  const std::vector<std::vector<std::uint32_t>> bad = {
      {make_word(Step::branch, 3)},           // no such node
      {make_word(Step::branch, 1)},           // a leaf
      {make_word(Step::leaf, 0)},             // a branch
      {make_word(Step::partial_leaf, 1), 3},  // not partial
      {make_word(Step::partial_leaf, 1)},     // half a step
      {make_word(Step::shade, 2)},
      {make_word(Step::light, 1)},
      {make_word(Step::texel, 1), 0},
      {make_word(Step::texel, 0), 4},
      {0xf0000000U},  // no such step
  };
  for (const auto& words : bad) {
    EXPECT_THROW(validate(small_log(words)), sim::InternalError);
  }
}

TEST(WorkLog, RefusesBrokenOffsetsAndTrees) {
  WorkLog log = small_log({make_word(Step::ray, 0)});
  log.rows[0].begin = {0, 2};
  EXPECT_THROW(validate(log), sim::InternalError);
  log.rows[0].begin = {1, 1};
  EXPECT_THROW(validate(log), sim::InternalError);
  log.rows[0].begin = {0};
  EXPECT_THROW(validate(log), sim::InternalError);
  log = small_log({});
  log.rows.clear();
  EXPECT_THROW(validate(log), sim::InternalError);
  log = small_log({});
  log.topology.entries[1] = 3;
  EXPECT_THROW(validate(log), sim::InternalError);
  log = small_log({});
  log.topology.nodes[2].first = 4;
  EXPECT_THROW(validate(log), sim::InternalError);
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
            words.push_back(make_word(Step::ray, 2U | i << 2U));
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
    RC_ASSERT(result.words == words);
    RC_ASSERT(result.begin == begin);
  }
}

}  // namespace
}  // namespace marti::processors
