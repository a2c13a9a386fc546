#include "scenes/animated.h"

#include <array>
#include <bit>
#include <cmath>
#include <sstream>
#include <utility>

#include "scenes/part_error.h"
#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

class OnePose : public PoseSource {
 public:
  OnePose(Scene scene, FileUse use) : scene_(std::move(scene)), use_(std::move(use)) {}
  [[nodiscard]] Scene at(double /*seconds*/) const override { return scene_; }
  [[nodiscard]] bool moves() const override { return false; }
  [[nodiscard]] double duration() const override { return 0.0; }
  [[nodiscard]] MotionFacts facts() const override { return {}; }
  [[nodiscard]] FileUse file_use() const override { return use_; }

 private:
  Scene scene_;
  FileUse use_;
};

using Bits = std::array<std::uint64_t, 9>;

Bits bits_of(const Scene& scene, const Triangle& triangle) {
  Bits bits{};
  std::size_t next = 0;
  for (const std::uint32_t vertex : triangle.vertex) {
    for (int axis = 0; axis < 3; ++axis) {
      bits[next++] = std::bit_cast<std::uint64_t>(scene.positions[vertex][axis]);
    }
  }
  return bits;
}

}  // namespace

AnimatedScene::AnimatedScene(Scene only, FileUse use)
    : source_(std::make_shared<OnePose>(std::move(only), std::move(use))) {}

Scene AnimatedScene::at(double seconds) const {
  if (!std::isfinite(seconds)) {
    throw PartError("time", "the time of a pose must be a finite number of seconds");
  }
  return source_->at(seconds);
}

Scene AnimatedScene::asked_for(double seconds, const std::string& name) const {
  if (seconds != 0.0 && !moves()) {
    std::ostringstream text;
    text << name << ": its pose at " << seconds << " s is asked for, but no animation plays";
    throw PartError("time", text.str());
  }
  return at(seconds);
}

std::vector<std::uint32_t> moved_primitives(const Scene& before, const Scene& after) {
  sim::ensure(before.triangles.size() == after.triangles.size(),
              "poses of one scene must have the same number of triangles");
  std::vector<std::uint32_t> moved;
  for (std::size_t i = 0; i < before.triangles.size(); ++i) {
    if (bits_of(before, before.triangles[i]) != bits_of(after, after.triangles[i])) {
      moved.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return moved;
}

std::string describe(const MotionFacts& facts) {
  std::ostringstream out;
  out << "animations: " << facts.animations.size() << "\n";
  for (std::size_t i = 0; i < facts.animations.size(); ++i) {
    const AnimationFacts& animation = facts.animations[i];
    out << "animation " << i << ": '" << sim::shown(animation.name) << "', " << animation.duration << " s, "
        << animation.channels << " channels" << (static_cast<int>(i) == facts.chosen ? " (plays)" : "")
        << "\n";
  }
  out << "skins: " << facts.skins << "\n"
      << "morph targets: " << facts.morph_targets << "\n";
  return out.str();
}

}  // namespace marti::scenes
