// `marti run --within`: its estimates are as narrow as was asked for, and it gives none where none may be
// given.
#include "studies/estimate/within.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "bench/estimates/allowances.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/run/prepared_frame.h"

namespace marti::studies {

using namespace estimate;
using namespace keys;
using namespace run;

namespace {

TEST(Within, TolerancesArePercentagesOrFractions) {
  EXPECT_DOUBLE_EQ(parse_tolerance("2%"), 0.02);
  EXPECT_DOUBLE_EQ(parse_tolerance("2 %"), 0.02);
  EXPECT_DOUBLE_EQ(parse_tolerance("0.02"), 0.02);
  EXPECT_EQ(parse_tolerance("0"), 0.0);
  EXPECT_EQ(parse_tolerance("0%"), 0.0);
  EXPECT_EQ(parse_tolerance("100%"), 1.0);
  for (const char* text : {"", "%", "x", "2", "101 %", "-1 %", "nan", "inf", "1e999", "2 % %", "0x1"}) {
    EXPECT_THROW((void)parse_tolerance(text), sim::UserError) << text;
  }
}

TEST(Within, WhatIsNotSampledSaysWhy) {
  processors::machine::MachineConfig machine;
  EXPECT_FALSE(not_sampled(machine));
  machine.packets.width = 7;
  ASSERT_TRUE(not_sampled(machine));
  EXPECT_NE(not_sampled(machine)->find("these have 7 x 8"), std::string::npos);
  const auto refused = [](auto change, const std::string& word) {
    processors::machine::MachineConfig other;
    change(other);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, word, not_sampled(other).value_or("it is sampled"));
  };
  using processors::machine::MachineConfig;
  refused([](MachineConfig& m) { m.scheme = processors::machine::Scheme::space; }, "scheme");
  refused([](MachineConfig& m) { m.contexts = 2; }, "context");
  refused([](MachineConfig& m) { m.build.sharing = processors::machine::Sharing::shared; }, "build.sharing");
  refused([](MachineConfig& m) { m.clusters = 2; }, "cluster");
  refused([](MachineConfig& m) { m.placement = processors::machine::Placement::replicated; }, "placement");
  FrameConfig frame;
  EXPECT_FALSE(not_sampled(frame));
  frame.render.voxel_cut = 1.0;
  EXPECT_TRUE(not_sampled(frame));
  frame.render.voxel_cut = 0.0;
  frame.render.integrator = processors::program::Integrator::path;
  ASSERT_TRUE(not_sampled(frame));
  EXPECT_NE(not_sampled(frame)->find("image.integrator"), std::string::npos);
}

FrameConfig teapot(std::uint32_t side) {
  FrameConfig frame;
  frame.scene = "teapot:4";
  frame.structure = "octree";
  frame.render.width = side;
  frame.render.height = side;
  frame.render.max_depth = 2;
  frame.memory = sim::MemoryBudget(std::uint64_t{1} << 32U);
  return frame;
}

WithinAnswer answer_of(const PreparedFrame& prepared, const processors::machine::MachineConfig& machine,
                       double tolerance, double* traced = nullptr, std::uint64_t seed = 1) {
  const processors::program::RenderOptions& render = prepared.config().render;
  SampledFrame frame = estimate::sampled_frame(prepared);
  const processors::machine::PacketList packets(render.width, render.height, machine.packets);
  const WithinAnswer answer = estimate_within(frame, packets, machine, tolerance, seed);
  if (traced != nullptr && answer.estimate) {
    *traced = answer.estimate->traced.pixels;
  }
  return answer;
}

// Estimates are never wider than asked for, need more pixels for less, and nearly all hold the exact figures.
// The scene is one of those that the errors were measured on, the view and the machines are not.
TEST(Within, AnEstimateIsNeverWiderThanAskedForAndHolds) {
  const PreparedFrame prepared(teapot(256));
  const processors::program::Frame whole = prepared.trace();
  int estimates = 0;
  std::uint64_t seed = 0;
  std::array<int, figure_count> held{};
  int not_fewer = 0;
  for (const std::uint32_t nodes : {1, 2, 4, 8}) {
    for (const std::uint64_t cache : {2048, 8192, 65536}) {
      processors::machine::MachineConfig machine;
      machine.nodes = nodes;
      machine.packets = {4, 4, processors::machine::PacketOrder::scanline};
      machine.cache.cache.size = cache;
      const MachineFigures exact = figures_of(machine, processors::replay::replay(*whole.log, machine));
      double last = 0.0;
      ++seed;
      for (const double tolerance : {0.5, 0.2, 0.1}) {
        double traced = 0.0;
        const WithinAnswer answer = answer_of(prepared, machine, tolerance, &traced, seed);
        if (!answer.estimate) {
          EXPECT_NE(answer.reason, "");
          continue;
        }
        ++estimates;
        const Estimate& found = answer.estimate->sampled.machine;
        EXPECT_LE(found.half_width[Figure::end], tolerance);
        EXPECT_LE(found.half_width[Figure::speed_up], tolerance);
        EXPECT_GE(traced, last);
        EXPECT_LE(traced, 0.5);
        last = traced;
        not_fewer += found.fewest_misses <= exact[Figure::misses] ? 1 : 0;
        for (const Figure figure : {Figure::end, Figure::misses, Figure::use, Figure::wait}) {
          const double error = bench::error_of(figure, found.value[figure], exact[figure]);
          held.at(static_cast<std::size_t>(figure)) += std::abs(error) <= found.half_width[figure] ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GE(estimates, 24);
  const auto held_of = [&](Figure figure) { return held.at(static_cast<std::size_t>(figure)); };
  EXPECT_GE(held_of(Figure::end), estimates * 8 / 10) << estimates;
  EXPECT_GE(held_of(Figure::use), estimates * 8 / 10) << estimates;
  // A frame as small as this has few windows with many misses, and a sample may have none of them.
  EXPECT_GE(held_of(Figure::misses), estimates * 6 / 10) << estimates;
  EXPECT_GE(held_of(Figure::wait), estimates * 6 / 10) << estimates;
  EXPECT_GE(not_fewer, estimates * 95 / 100) << estimates;
}

TEST(Within, ASampleThatWouldBeMostOfTheFrameIsNotTaken) {
  const PreparedFrame small(teapot(64));
  processors::machine::MachineConfig machine;
  machine.nodes = 64;
  EXPECT_FALSE(answer_of(small, machine, 0.2).estimate);
  EXPECT_NE(answer_of(small, machine, 0.2).reason.find("of the pixels"), std::string::npos);
  EXPECT_NE(answer_of(small, machine, 1e-6).reason.find("beside what a larger"), std::string::npos);
}

// Nothing is sampled of the smallest frames, of packets larger than the image, of more nodes than packets.
TEST(Within, SmallFramesHaveNoSample) {
  for (const std::uint32_t side : {1, 2, 9}) {
    const PreparedFrame prepared(teapot(side));
    for (const std::uint32_t packet : {1, 64}) {
      for (const std::uint32_t nodes : {1, 500}) {
        processors::machine::MachineConfig machine;
        machine.nodes = nodes;
        machine.packets = {packet, packet, processors::machine::PacketOrder::scanline};
        EXPECT_FALSE(answer_of(prepared, machine, 0.5).estimate) << side << ' ' << packet << ' ' << nodes;
      }
    }
  }
}

}  // namespace
}  // namespace marti::studies
