// The measured errors that are built into the program, and the choices made by them.
#include "studies/estimate/measured_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/estimate/within.h"
#include "studies/run/prepared_frame.h"

namespace marti::studies {
namespace {

TEST(MeasuredErrors, CoverEveryClassOfLoad) {
  const std::vector<MeasuredError> errors = parse_measured_errors(measured_errors_csv());
  ASSERT_EQ(errors.size(), load_classes.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_EQ(errors[i].use_to, load_classes[i]);
    EXPECT_GE(errors[i].cases, 50U);
    EXPECT_GE(errors[i].covered, 0.9);
    EXPECT_LE(errors[i].covered, 1.0);
    EXPECT_GE(errors[i].allowance[Figure::end], 0.0);
    EXPECT_EQ(load_class_of(load_classes[i]), i);
  }
  EXPECT_EQ(load_class_of(0.0), 0U);
  EXPECT_EQ(load_class_of(0.31), 1U);
  EXPECT_EQ(load_class_of(1.01), load_classes.size() - 1);
}

TEST(MeasuredErrors, AnotherTableIsAFault) {
  const std::string good(measured_errors_csv());
  const auto refused = [](const std::string& text) {
    EXPECT_THROW((void)parse_measured_errors(text), sim::InternalError) << text.substr(0, 200);
  };
  const std::string header = good.substr(0, good.find('\n') + 1);
  const std::string first = "2,0.3,60,0.95,0.01,0.01,0.1,0.1,1\n";
  const std::string second = "2,0.7,60,0.95,0.01,0.01,0.1,0.1,1\n";
  const std::string third = "2,1,60,0.95,0.01,0.01,0.1,0.1,inf\n";
  EXPECT_EQ(parse_measured_errors(header + first + second + third).size(), 3U);
  refused("");
  refused("a,b\n");
  refused(header);
  refused(header + first + second);
  refused(header + second + first + third);
  refused(header + first + second + third + third);
  refused(header + "9" + first.substr(1) + second + third);  // the version
  refused(header + first + second + "2,1,60,half,0.01,0.01,0.1,0.1,1\n");
  refused(header + first + second + "2,1,60,-0.5,0.01,0.01,0.1,0.1,1\n");
  refused(header + first + second + "2,1,60,0.5,0.01,0.01,0.1,0.1\n");
  refused(header + first + second + "2,1,60,0.5,0.01,0.01,0.1,0.1,1,1\n");
}

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
  processors::MachineConfig machine;
  EXPECT_FALSE(not_sampled(machine));
  machine.scheme = processors::Scheme::pipeline;
  ASSERT_TRUE(not_sampled(machine));
  EXPECT_NE(not_sampled(machine)->find("scheme"), std::string::npos);
  FrameConfig frame;
  EXPECT_FALSE(not_sampled(frame));
  frame.render.voxel_cut = 1.0;
  EXPECT_TRUE(not_sampled(frame));
}

FrameConfig teapot(std::uint32_t side) {
  FrameConfig frame;
  frame.scene = "teapot:4";
  frame.render.width = side;
  frame.render.height = side;
  frame.render.max_depth = 2;
  frame.memory = sim::MemoryBudget(std::uint64_t{1} << 32U);
  return frame;
}

WithinAnswer answer_of(const PreparedFrame& prepared, const processors::MachineConfig& machine,
                       double tolerance, double* traced = nullptr) {
  const processors::RenderOptions& render = prepared.config().render;
  SampledFrame frame(render.width, render.height,
                     [&](const processors::PixelSet& only, const processors::Frame* before) {
                       return prepared.trace(&only, before);
                     });
  const processors::PacketList packets(render.width, render.height, machine.packets);
  const WithinAnswer answer = estimate_within(frame, packets, machine, tolerance);
  if (traced != nullptr && answer.estimate) {
    *traced = frame.traced().pixels;
  }
  return answer;
}

// Estimates are never wider than asked for, need more pixels for less, and hold the exact figures.
TEST(Within, AnEstimateIsNeverWiderThanAskedForAndHolds) {
  const PreparedFrame prepared(teapot(256));
  const processors::Frame whole = prepared.trace();
  processors::MachineConfig machine;
  machine.nodes = 4;
  machine.packets = {4, 4, processors::PacketOrder::scanline};
  const MachineFigures exact = figures_of(machine, processors::replay(*whole.log, machine));
  double last = 0.0;
  int estimates = 0;
  for (const double tolerance : {0.5, 0.2, 0.1, 0.05}) {
    double traced = 0.0;
    const WithinAnswer answer = answer_of(prepared, machine, tolerance, &traced);
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
    for (const Figure figure : {Figure::end, Figure::misses, Figure::use, Figure::wait}) {
      EXPECT_LE(std::abs(error_of(figure, found.value[figure], exact[figure])), found.half_width[figure])
          << figure_names[static_cast<std::size_t>(figure)] << ' ' << tolerance;
    }
  }
  EXPECT_GE(estimates, 2);
}

TEST(Within, ASampleThatWouldBeMostOfTheFrameIsNotTaken) {
  const PreparedFrame small(teapot(64));
  processors::MachineConfig machine;
  machine.nodes = 64;
  EXPECT_FALSE(answer_of(small, machine, 0.2).estimate);
  EXPECT_NE(answer_of(small, machine, 0.2).reason.find("of the pixels"), std::string::npos);
  EXPECT_NE(answer_of(small, machine, 1e-6).reason.find("have been measured"), std::string::npos);
}

}  // namespace
}  // namespace marti::studies
