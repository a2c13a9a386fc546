// A sequence of frames: what moves between them, and the box around all.
#include "studies/frames/frame_sequence.h"

#include <bit>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenes/open.h"
#include "scenes/procedural.h"

namespace marti::studies {

using namespace frames;
using namespace keys;

namespace {

FrameConfig swing_frames(std::uint32_t count, std::uint32_t first, double rate) {
  FrameConfig config;
  config.scene = std::string(MARTI_SOURCE) + "/configs/scenes/swing.glb";
  config.frames = {count, first, rate};
  return config;
}

TEST(FrameSequence, FramesComeInOrderAtTheirTimes) {
  const FrameSequence sequence(swing_frames(5, 3, 16.0));
  EXPECT_EQ(sequence.size(), 5U);
  std::vector<std::uint32_t> numbers;
  sequence.visit([&](const PosedFrame& frame) {
    numbers.push_back(frame.number);
    EXPECT_EQ(frame.seconds, frame.number / 16.0);
    const scenes::Scene pose = sequence.scene().at(frame.seconds);
    EXPECT_TRUE(scenes::moved_primitives(pose, frame.scene).empty());
  });
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{3, 4, 5, 6, 7}));
}

TEST(FrameSequence, WhatIsNotListedHasNotMoved) {
  const FrameSequence sequence(swing_frames(8, 0, 8.0));
  std::vector<scenes::Scene> poses;
  std::uint32_t frames_that_moved = 0;
  sequence.visit([&](const PosedFrame& frame) {
    poses.push_back(frame.scene);
    if (poses.size() == 1) {
      EXPECT_TRUE(frame.moved.empty());
      return;
    }
    const scenes::Scene& before = poses[poses.size() - 2];
    std::set<std::uint32_t> moved(frame.moved.begin(), frame.moved.end());
    EXPECT_EQ(moved.size(), frame.moved.size());
    for (std::uint32_t id = 0; id < frame.scene.triangles.size(); ++id) {
      bool same = true;
      for (std::size_t k = 0; k < 3; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
          const double a = before.positions[before.triangles[id].vertex[k]][axis];
          const double b = frame.scene.positions[frame.scene.triangles[id].vertex[k]][axis];
          same = same && std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
        }
      }
      EXPECT_EQ(same, !moved.contains(id)) << id;
    }
    frames_that_moved += frame.moved.empty() ? 0U : 1U;
    EXPECT_LT(frame.moved.size(), frame.scene.triangles.size() / 2) << "most of the scene stands still";
  });
  EXPECT_EQ(frames_that_moved, 7U);
}

TEST(FrameSequence, TheBoxIsTightAroundAllFrames) {
  const FrameSequence sequence(swing_frames(8, 0, 8.0));
  scenes::Bounds all;
  sequence.visit([&](const PosedFrame& frame) {
    const scenes::Bounds bounds = scenes::bounds_of(frame.scene);
    all.include(bounds.lo);
    all.include(bounds.hi);
  });
  EXPECT_EQ(all.lo, sequence.bounds().lo);
  EXPECT_EQ(all.hi, sequence.bounds().hi);
}

/// One triangle whose first corner is at the time.
class Rising : public scenes::PoseSource {
 public:
  [[nodiscard]] scenes::Scene at(double seconds) const override {
    scenes::Scene scene;
    scene.positions = {{seconds, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    scene.triangles = {{{0, 1, 2}, 0, 0}};
    return scene;
  }
  [[nodiscard]] bool moves() const override { return true; }
  [[nodiscard]] double duration() const override { return 100.0; }
  [[nodiscard]] scenes::MotionFacts facts() const override { return {}; }
};

TEST(FrameSequence, TheBoxHoldsWhatOnlyMiddleFramesReach) {
  const FrameSequence sequence(scenes::AnimatedScene(std::make_shared<Rising>()), {4, 2, 0.5});
  EXPECT_EQ(sequence.bounds().hi.x, 10.0) << "frames 2 to 5 at two seconds each";
  EXPECT_EQ(sequence.bounds().lo.x, 0.0);
}

TEST(FrameSequence, AStillSceneHasOnePose) {
  const FrameSequence sequence(scenes::AnimatedScene(scenes::make_procedural("tetra:2")), {3, 1, 24.0});
  std::uint32_t frames = 0;
  sequence.visit([&](const PosedFrame& frame) {
    ++frames;
    EXPECT_TRUE(frame.moved.empty());
    EXPECT_EQ(frame.scene.triangles.size(), 16U);
  });
  EXPECT_EQ(frames, 3U);
}

}  // namespace
}  // namespace marti::studies
