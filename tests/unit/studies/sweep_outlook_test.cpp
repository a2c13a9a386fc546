// What a sweep will take, before it runs: which frames are sampled, and what is scaled up from them.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "studies/run/functional_run.h"
#include "studies/sweep/frame_samples.h"
#include "studies/sweep/machine_samples.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/sweep_outlook.h"

namespace marti::studies {

using namespace keys;
using namespace run;
using namespace sweep;

namespace {

SweepPlan planned(const std::string& text) {
  sim::Config config = sim::Config::from_text(sweep_schema(), text, "test.toml");
  return plan_sweep(config);
}

const std::string two_scenes = R"([image]
height = 64
[cache]
size = "1 KiB"
ways = 2
[sweep.axes]
scene.source = ["tetra:1", "tetra:3"]
image.width = [32, 64, 128, 256]
machine.nodes = [1, 2, 4]
)";

std::vector<std::size_t> all_frames(const SweepPlan& plan) {
  std::vector<std::size_t> frames(plan.frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = i;
  }
  return frames;
}

TEST(FrameSamples, OneOfEachSceneStandsForAllSizes) {
  const SweepPlan plan = planned(two_scenes);
  ASSERT_EQ(plan.frames.size(), 8U);
  // Frames that differ in size alone need no other sample, however much time there is.
  const FrameSamples samples(plan, all_frames(plan), [] { return false; });
  ASSERT_EQ(samples.samples().size(), 2U);
  const std::vector<FrameEstimate> estimates = samples.estimates();
  ASSERT_EQ(estimates.size(), 8U);
  std::map<std::string, std::uint64_t> primitives = {{"tetra:1", 4}, {"tetra:3", 64}};
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const FrameConfig& frame = plan.frames[i].config;
    const FrameSample& sample = samples.samples()[estimates[i].sample];
    EXPECT_EQ(sample.large.log->primitives, primitives[frame.scene]);
    EXPECT_LE(sample.large.log->width, 96U);
    EXPECT_EQ(estimates[i].scale * sample.rays,
              static_cast<double>(frame.render.width) * frame.render.height);
    EXPECT_EQ(estimates[i].log_bytes, sample.large.bytes * estimates[i].scale);
    EXPECT_EQ(estimates[i].prepare_seconds, sample.prepare_seconds) << "as long at any size";
  }
}

TEST(FrameSamples, OneIsEnoughWhenThereIsNoTime) {
  const SweepPlan plan = planned(two_scenes);
  const FrameSamples samples(plan, all_frames(plan), [] { return true; });
  EXPECT_EQ(samples.samples().size(), 1U);
  EXPECT_EQ(samples.estimates().size(), plan.frames.size());
}

TEST(FrameSamples, AFrameThatIsSmallIsItsOwnSample) {
  const SweepPlan plan = planned(
      "[scene]\nsource = \"tetra:2\"\n[image]\nwidth = 40\nheight = 30\n"
      "[sweep.axes]\nmachine.nodes = [1, 2]\n");
  const FrameSamples samples(plan, {0}, [] { return false; });
  const FunctionalRun whole = run_functional(plan.frames[0].config);
  EXPECT_EQ(samples.samples()[0].small.log, nullptr);
  EXPECT_EQ(samples.samples()[0].large.bytes, static_cast<double>(whole.totals.bytes));
  EXPECT_EQ(samples.estimates()[0].scale, 1.0);
}

// The log of a larger image is foreseen within a tenth.
TEST(FrameSamples, ALogGrowsWithItsImage) {
  const SweepPlan plan = planned(
      "[scene]\nsource = \"tetra:4\"\n[image]\nwidth = 256\nheight = 256\n"
      "[sweep.axes]\nmachine.nodes = [1, 2]\n");
  const FrameSamples samples(plan, {0}, [] { return false; });
  const double bytes = static_cast<double>(run_functional(plan.frames[0].config).totals.bytes);
  EXPECT_NEAR(samples.estimates()[0].log_bytes / bytes, 1.0, 0.1);
}

TEST(MachineSamples, NothingIsEstimatedForNothing) {
  const SweepPlan plan = planned(two_scenes);
  const FrameSamples samples(plan, all_frames(plan), [] { return false; });
  const std::vector<FrameEstimate> estimates = samples.estimates();
  std::size_t asked = 0;
  const auto frame_of = [&](std::size_t frame) -> const FrameEstimate& { return estimates[frame]; };
  EXPECT_FALSE(estimate_machines(plan, {}, samples, frame_of, [&] { return ++asked > 100; }));
  const auto some = estimate_machines(plan, {0, 1, 2}, samples, frame_of, [] { return true; });
  ASSERT_TRUE(some);
  EXPECT_GT(some->timing, 0.0);
  EXPECT_GT(some->stripping, 0.0) << "three machines of LRU caches share a stripped log";
}

SweepOutlook outlook_of_all(const std::string& text) {
  const SweepPlan plan = planned(text);
  return outlook_of(plan, std::vector<bool>(plan.machines.size()), std::vector<bool>(plan.frames.size()), 2);
}

// A scene of a million triangles, and caches of gigabytes, are too large for a sample: their time is not
// estimated. Beside small machines large ones are not sampled.
TEST(SweepOutlook, TheLargestScenesAndMachinesAreNotSampled) {
  const std::string image = "[image]\nwidth = 8\nheight = 8\n";
  const std::string caches = "scene.source = \"tetra:2\"\n" + image + "[sweep.axes]\ncache.size = ";
  const SweepOutlook large = outlook_of_all(caches + "[\"2 GiB\", \"4 GiB\"]\n");
  EXPECT_FALSE(large.seconds);
  EXPECT_TRUE(large.not_estimated);
  EXPECT_GT(large.machine_bytes, std::uint64_t{1} << 28U);
  EXPECT_TRUE(outlook_of_all(caches + "[\"4 GiB\", \"1 KiB\"]\n").seconds);
  const SweepPlan plan =
      planned("scene.source = \"tetra:10\"\n" + image + "[sweep.axes]\nmachine.nodes = [1, 2]\n");
  const SweepOutlook scene = outlook_of(plan, {false, false}, {false}, 2);
  EXPECT_FALSE(scene.seconds);
  EXPECT_TRUE(scene.not_estimated);
  EXPECT_FALSE(scene.log_bytes);
  EXPECT_NE(describe(plan, scene).find("not estimated"), std::string::npos);
}

TEST(SweepOutlook, WhatIsDoneCostsNothing) {
  const SweepPlan plan = planned(two_scenes);
  const SweepOutlook outlook = outlook_of(plan, std::vector<bool>(plan.machines.size(), true),
                                          std::vector<bool>(plan.frames.size(), true), 2);
  EXPECT_EQ(outlook.machines_done, plan.machines.size());
  EXPECT_EQ(outlook.frames_done, plan.frames.size());
  EXPECT_FALSE(outlook.seconds);
  // A machine that is left needs its frame, though that has been traced.
  std::vector<bool> machines(plan.machines.size(), true);
  machines.back() = false;
  const SweepOutlook one = outlook_of(plan, machines, std::vector<bool>(plan.frames.size(), true), 2);
  EXPECT_EQ(one.frames_done, plan.frames.size() - 1);
  ASSERT_TRUE(one.seconds);
  EXPECT_GT(*one.seconds, 0.0);
}

}  // namespace
}  // namespace marti::studies
