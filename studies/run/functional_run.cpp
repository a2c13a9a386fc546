#include "studies/run/functional_run.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <utility>

#include "studies/run/expected_times.h"
#include "studies/run/prepared_frame.h"
#include "studies/run/saved_frame.h"

namespace marti::studies::run {

namespace {

// An image of at most this many pixels a side is rendered without estimating its memory first,
constexpr std::uint32_t sample_side = 64;
// if it also has at most this many samples a pixel.
constexpr std::uint32_t sample_rays = 4;

}  // namespace

// FNV-1a (Fowler, Noll, Vo) over the bits of all pixels.
std::uint64_t image_hash(const processors::program::Image& image) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const glm::vec3& pixel : image.pixels) {
    for (int channel = 0; channel < 3; ++channel) {
      hash = (hash ^ std::bit_cast<std::uint32_t>(pixel[channel])) * 0x100000001b3ULL;
    }
  }
  return hash;
}

// Estimates the bytes of log and image from a small rendering of the same view. They are doubled, because a
// row grows by doubling and the coarse sample may miss what is expensive.
void refuse_beyond_memory(const keys::FrameConfig& config, const scenes::Scene& scene,
                          const accel::TriangleSet& triangles, const accel::Structure& structure) {
  processors::program::RenderOptions sample = keys::made_small(config.render, sample_side);
  if (sample.width == config.render.width && sample.height == config.render.height &&
      sample.samples <= sample_rays) {
    return;
  }
  sample.samples = std::min(sample.samples, sample_rays);
  sample.record = true;
  sample.hits = false;
  sample.voxel_cut = 0.0;  // a coarse sample would cut more than the frame
  sim::WorkMeter of_sample(config.meter);
  sample.meter = &of_sample;
  const auto begin = std::chrono::steady_clock::now();
  const processors::program::Frame frame = processors::program::render(scene, triangles, structure, sample);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const double pixels = static_cast<double>(config.render.width) * config.render.height;
  const double frames = config.exact_too ? 2.0 : 1.0;
  const processors::program::LogTotals totals = processors::program::totals_of(*frame.log);
  if (config.expected != nullptr) {
    config.expected->sampled(std::uint64_t{sample.width} * sample.height * sample.samples, took.count(),
                             totals);
  }
  std::uint64_t beside = 0;
  for (const processors::program::LogRow& row : frame.log->rows) {
    for (const processors::program::RowWords* const words : row.beside()) {
      beside += words->words.size() * sizeof(std::uint32_t);
    }
  }
  const double bytes = frames * static_cast<double>(totals.bytes + beside) /
                           (static_cast<double>(sample.width) * sample.height * sample.samples) * pixels *
                           config.render.samples * 2.0 +
                       frames * pixels * sizeof(glm::vec3) +
                       (config.render.hits ? pixels * sizeof(processors::program::GivenHit) : 0.0);
  config.memory.require(
      static_cast<std::uint64_t>(std::min(bytes, 9e18)), "the image and its work log may take",
      config.open.rays.empty() ? "lower image.width, image.height, image.samples or image.max_depth"
                               : "take fewer rays");
}

FunctionalRun run_functional(const keys::FrameConfig& config) {
  if (config.log != nullptr) {
    return open_saved_frame(config);
  }
  const PreparedFrame frame(config);
  return frame.finish(frame.trace());
}

FunctionalRun run_functional(const keys::FrameConfig& config, const scenes::Scene& scene) {
  const PreparedFrame frame(config, scene);
  return frame.finish(frame.trace());
}

}  // namespace marti::studies::run
