#include "studies/sweep/frame_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "sim/key_error.h"
#include "studies/host/cpu_time.h"
#include "studies/run/open_frame.h"
#include "studies/run/prepared_frame.h"
#include "studies/run/scene_hash.h"

namespace marti::studies::sweep {

namespace {

constexpr double large_side = 96;
constexpr double fewest_side = 16;
constexpr std::uint64_t most_scene_bytes = std::uint64_t{100} << 20U;  // of most_sample_bytes
constexpr std::size_t another_scene = 1'000'000;                       // more than a frame has settings
constexpr std::size_t unlike_all = 2 * another_scene;

double rays_of(const processors::program::RenderOptions& options) {
  return static_cast<double>(options.width) * options.height * options.samples;
}

// All that a frame is made by, but for the size of its image.
std::vector<std::uint64_t> settings_of(const SweepFrame& frame) {
  std::vector<std::uint64_t> settings;
  for (const sim::EffectiveValue& value : frame.settings) {
    if (value.key != "image.width" && value.key != "image.height") {
      settings.push_back(std::hash<std::string>()(value.key + "=" + value.value));
    }
  }
  std::ranges::sort(settings);
  return settings;
}

std::size_t unlike(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  std::vector<std::uint64_t> different;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(different));
  return different.size();
}

SmallLog log_of(const run::FunctionalRun& run) {
  return {run.frame.log, static_cast<double>(run.totals.bytes)};
}

// As a worker of the sweep traces the frame, but small.
FrameSample sample_of(const keys::FrameConfig& frame) {
  keys::FrameConfig config = frame;
  // As many rays as large_side has with one sample a pixel.
  config.render =
      keys::made_small(config.render, std::max(fewest_side, large_side / std::sqrt(config.render.samples)));
  const sim::MemoryBudget of_scene(std::min(config.memory.limit(), most_scene_bytes), true);
  config.open.file.memory = of_scene;
  config.memory = sim::MemoryBudget(std::min(config.memory.limit(), most_sample_bytes), true);
  config.render.voxel_cut = 0.0;  // a coarse image would cut more than the frame
  const double begin = host::process_cpu_seconds();
  const scenes::Scene scene = run::open_frame(config);
  of_scene.require(scenes::host_bytes(scene) + scenes::host_bytes_of_facts(scene), "the scene takes", {});
  static_cast<void>(run::scene_hash(scene));
  const run::PreparedFrame prepared(config, scene);
  const double ready = host::process_cpu_seconds();
  const run::FunctionalRun run = prepared.finish(prepared.trace());
  FrameSample sample{
      log_of(run), {}, rays_of(config.render), ready - begin, host::process_cpu_seconds() - ready};
  if (rays_of(config.render) != rays_of(frame.render)) {
    const double side = std::max(config.render.width, config.render.height);
    sample.small = log_of(prepared.part(prepared.trace_small(side / 2.0)));
  }
  return sample;
}

}  // namespace

FrameSamples::FrameSamples(const SweepPlan& plan, std::vector<std::size_t> frames,
                           const std::function<bool()>& enough)
    : plan_(plan), frames_(std::move(frames)), unlike_(frames_.size(), unlike_all), nearest_(frames_.size()) {
  for (const std::size_t frame : frames_) {
    settings_.push_back(settings_of(plan_.frames[frame]));
  }
  do {
    take_next();
  } while (std::ranges::any_of(unlike_, [](std::size_t each) { return each != 0; }) && !too_large_ &&
           !enough());
}

void FrameSamples::take_next() {
  const std::size_t most = *std::ranges::max_element(unlike_);
  // Of several the one in the middle, because the ends of an axis are the least like the others.
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (unlike_[i] == most) {
      candidates.push_back(i);
    }
  }
  const std::size_t chosen = candidates[candidates.size() / 2];
  const SweepFrame& frame = plan_.frames[frames_[chosen]];
  try {
    samples_.push_back(sample_of(frame.config));
  } catch (const sim::KeyError& error) {
    // The sweep itself may have more memory than a sample.
    if (error.key() != sim::memory_limit_key || frame.config.memory.limit() <= most_scene_bytes) {
      throw;
    }
    too_large_ = true;
    return;
  }
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const std::size_t distance =
        unlike(settings_[i], settings_[chosen]) +
        (plan_.frames[frames_[i]].config.scene == frame.config.scene ? 0 : another_scene);
    if (distance < unlike_[i]) {
      unlike_[i] = distance;
      nearest_[i] = samples_.size() - 1;
    }
  }
}

std::vector<FrameEstimate> FrameSamples::estimates() const {
  std::vector<FrameEstimate> estimates;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const FrameSample& sample = samples_[nearest_[i]];
    const double scale = rays_of(plan_.frames[frames_[i]].config.render) / sample.rays;
    estimates.push_back({nearest_[i], scale, sample.prepare_seconds, sample.trace_seconds * scale,
                         sample.large.bytes * scale});
  }
  return estimates;
}

}  // namespace marti::studies::sweep
