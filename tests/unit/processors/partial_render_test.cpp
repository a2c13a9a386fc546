// Frames that are rendered in parts: the parts together are the whole, byte for byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "processors/program/pixel_set.h"
#include "processors/program/recorder.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_TRUE(test::same_bytes(a.image, b.image));
  EXPECT_EQ(a.hit_hash, b.hit_hash);
  EXPECT_EQ(a.rays.traced, b.rays.traced);
  EXPECT_EQ(a.rays.hit, b.rays.hit);
  ASSERT_EQ(a.log->rows.size(), b.log->rows.size());
  for (std::size_t y = 0; y < a.log->rows.size(); ++y) {
    ASSERT_EQ(a.log->rows[y].words, b.log->rows[y].words) << y;
    ASSERT_EQ(a.log->rows[y].begin, b.log->rows[y].begin) << y;
  }
}

TEST(PixelSet, HoldsWhatWasAddedAndNotTakenAway) {
  for (const auto& [width, height] : {std::pair{1U, 1U}, {8U, 8U}, {13U, 7U}, {65U, 3U}}) {
    PixelSet set(width, height);
    EXPECT_EQ(set.count(), 0U);
    set.add(width - 1, height - 1);
    set.add(0, 0);
    EXPECT_EQ(set.count(), width * height == 1 ? 1U : 2U);
    EXPECT_TRUE(set.has(width - 1, height - 1));
    PixelSet rest(width, height);
    rest.add_all();
    EXPECT_EQ(rest.count(), std::uint64_t{width} * height);
    rest.remove(set);
    EXPECT_EQ(rest.count() + set.count(), std::uint64_t{width} * height);
    EXPECT_FALSE(rest.has(0, 0));
  }
}

class PartialRender : public testing::TestWithParam<RenderOptions> {};

RenderOptions small_image(RenderOptions options) {
  options.width = 37;
  options.height = 29;
  options.max_depth = 3;
  options.record = true;
  return options;
}

TEST_P(PartialRender, PartsTogetherAreTheWhole) {
  const Built built(scenes::make_procedural("teapot:2"), "octree");
  const RenderOptions options = small_image(GetParam());
  const Frame whole = built.render(options);
  std::mt19937_64 random(3);
  for (const std::uint64_t parts : {1, 2, 5}) {
    std::vector<PixelSet> sets(parts, PixelSet(options.width, options.height));
    for (std::uint32_t y = 0; y < options.height; ++y) {
      for (std::uint32_t x = 0; x < options.width; ++x) {
        sets[random() % parts].add(x, y);
      }
    }
    std::optional<Frame> frame;
    for (const PixelSet& set : sets) {
      RenderOptions part = options;
      part.only = &set;
      part.before = frame ? &*frame : nullptr;
      Frame more = built.render(part, 2);
      // The pixels of a part are those of the whole; no other has words.
      for (std::uint32_t y = 0; y < options.height && !frame; ++y) {
        for (std::uint32_t x = 0; x < options.width; ++x) {
          const auto words = more.log->pixel(x, y);
          const auto expected = whole.log->pixel(x, y);
          ASSERT_TRUE(set.has(x, y) ? std::equal(words.begin(), words.end(), expected.begin(), expected.end())
                                    : words.empty());
        }
      }
      frame = std::move(more);
    }
    expect_same(*frame, whole);
  }
}

// Every pixel of a window is the image's pixel in that place, in its colour and in its words, and what is
// counted of windows that cover the image adds up to what is counted of it.
TEST_P(PartialRender, WindowsTogetherAreTheImage) {
  const Built built(scenes::make_procedural("teapot:2"), "octree");
  const RenderOptions options = small_image(GetParam());
  const Frame whole = built.render(options);
  const std::array<std::uint32_t, 4> columns = {0, 1, 20, 37};
  const std::array<std::uint32_t, 3> rows = {0, 13, 29};
  RayCounts rays;
  std::uint64_t hit_hash = 0;
  for (std::size_t i = 0; i + 1 < columns.size(); ++i) {
    for (std::size_t j = 0; j + 1 < rows.size(); ++j) {
      RenderOptions part = options;
      part.window = {options.width, options.height, columns.at(i), rows.at(j)};
      part.width = columns.at(i + 1) - columns.at(i);
      part.height = rows.at(j + 1) - rows.at(j);
      const Frame frame = built.render(part);
      ASSERT_EQ(frame.image.width, part.width);
      ASSERT_EQ(frame.log->rows.size(), part.height);
      for (std::uint32_t y = 0; y < part.height; ++y) {
        for (std::uint32_t x = 0; x < part.width; ++x) {
          const std::uint32_t column = columns.at(i) + x;
          const std::uint32_t row = rows.at(j) + y;
          ASSERT_EQ(frame.image.at(x, y), whole.image.at(column, row)) << column << " " << row;
          const auto words = frame.log->pixel(x, y);
          const auto expected = whole.log->pixel(column, row);
          ASSERT_TRUE(std::equal(words.begin(), words.end(), expected.begin(), expected.end()));
        }
      }
      rays += frame.rays;
      hit_hash += frame.hit_hash;
    }
  }
  EXPECT_EQ(rays.traced, whole.rays.traced);
  EXPECT_EQ(rays.hit, whole.rays.hit);
  EXPECT_EQ(rays.voxels, whole.rays.voxels);
  EXPECT_EQ(hit_hash, whole.hit_hash);
}

INSTANTIATE_TEST_SUITE_P(OfAllKinds, PartialRender,
                         testing::Values(RenderOptions{}, RenderOptions{.samples = 3},
                                         RenderOptions{.floats = true}, RenderOptions{.mailboxes = true},
                                         RenderOptions{.voxel_cut = 2.0},
                                         RenderOptions{.integrator = Integrator::path, .samples = 2},
                                         RenderOptions{.integrator = Integrator::occlusion}));

// A pixel of many samples may have more words than the recorder's first buffer.
TEST(PartialRender, PixelsOfAnyLengthAreTakenOver) {
  for (const std::size_t first : {0, 40'000}) {
    RowRecorder recorder;
    recorder.begin_row(2);
    recorder.begin_pixel();
    LogRow before;
    before.words.assign(first, 1);
    before.words.resize(first + 200'000, 2);
    before.begin = {0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(first + 200'000)};
    recorder.copy(before, 0);
    recorder.begin_pixel();
    recorder.copy(before, 1);
    LogRow row;
    recorder.end_row(row);
    ASSERT_EQ(row.words.size(), first + 200'000);
    EXPECT_EQ(row.words.back(), 2U);
    EXPECT_EQ(row.begin[1], first);
    EXPECT_EQ(row.begin[2], first + 200'000);
  }
}

TEST(PartialRender, ASetOrFrameOfAnotherImageIsAFault) {
  const Built built(scenes::make_procedural("tetra:1"), "octree");
  RenderOptions options{.width = 8, .height = 8, .record = true};
  const PixelSet other(8, 7);
  options.only = &other;
  EXPECT_THROW((void)built.render(options), sim::InternalError);
  const PixelSet set(8, 8);
  options.only = &set;
  const Frame unrecorded = built.render({.width = 8, .height = 8});
  options.before = &unrecorded;
  EXPECT_THROW((void)built.render(options), sim::InternalError);
  const Frame first = built.render({.width = 8, .height = 8, .record = true});
  options.before = &first;
  options.only = nullptr;  // all are traced, so none is left for the first frame
  EXPECT_THROW((void)built.render(options), sim::InternalError);
}

}  // namespace
}  // namespace marti::processors
