#include "studies/error/rendering_keys.h"

#include <algorithm>
#include <string>

#include "processors/program/render.h"
#include "studies/keys/key_parts.h"

namespace marti::studies::error {

namespace {

// References have so many times the samples of what is held against them: their own noise adds at most 3 % to
// the error (robust enough without a correction: sqrt(1 + 1/16)).
constexpr std::uint32_t reference_factor = 16;

}  // namespace

void declare_rendering_error_keys(sim::Schema& schema) {
  using processors::program::max_ray_depth;
  using processors::program::max_samples;
  schema.section(
      "error.rendering",
      "only for `marti study error`: the settings of the renderer that are held against exact ones");
  schema.integer("error.rendering.side", 64, {1, 32768}, "pixels",
                 "the image is made so small that its longer side has at most this many");
  schema.integers("error.rendering.samples", {1, 2, 4, 8, 16, 32, 64}, {1, max_samples}, "rays",
                  "samples of a pixel, in the place of image.samples");
  schema.integer("error.rendering.reference_samples", 1024, {16, 65536}, "rays",
                 "samples of a pixel in each of the two references of the above: at least 16 times the most");
  schema.integers("error.rendering.depths", {1, 2, 3, 4, 5, 6, 7, 8}, {1, max_ray_depth}, "rays",
                  "longest chains of rays, in the place of image.max_depth");
  schema.integer("error.rendering.reference_depth", 16, {2, max_ray_depth}, "rays",
                 "longest chain of rays of the reference of the above");
  schema.reals(
      "error.rendering.weights", {0.001, 0.01, 0.05, 0.1, 0.2, 0.5}, {1e-9, 1.0}, "",
      "whitted: shares of a sample below which a ray is not traced, in the place of image.min_weight");
  schema.reals("error.rendering.voxel_cuts", {0.25, 1.0, 4.0, 16.0}, {1e-6, 1'000'000.0}, "pixels",
               "octree, no curved primitives: cuts, in the place of image.voxel_cut");
  schema.integer("error.rendering.seed", 1, {0, std::int64_t{1} << 62U}, "",
                 "of the samples, in the place of image.seed");
  schema.integer("error.rendering.repeats", 7, {1, 1000}, "",
                 "times that each run time is measured, in shuffled order");
}

RenderingErrorOptions read_rendering_error(sim::Config& config, const keys::FrameConfig& frame) {
  RenderingErrorOptions options;
  options.side = keys::count(config, "error.rendering.side");
  options.samples = keys::ascending<std::uint32_t>(config, "error.rendering.samples");
  options.reference_samples = keys::count(config, "error.rendering.reference_samples");
  if (options.samples.empty()) {
    config.fail("error.rendering.samples", "it is empty; give at least one number");
  }
  if (options.reference_samples < reference_factor * options.samples.back()) {
    config.fail("error.rendering.reference_samples",
                "it must be at least " + std::to_string(reference_factor) + " times the most of " +
                    "error.rendering.samples, " + std::to_string(reference_factor * options.samples.back()));
  }
  options.depths = keys::ascending<std::uint32_t>(config, "error.rendering.depths");
  options.reference_depth = keys::count(config, "error.rendering.reference_depth");
  if (!options.depths.empty() && options.depths.back() >= options.reference_depth) {
    config.fail("error.rendering.depths", std::to_string(options.depths.back()) +
                                              " is not below error.rendering.reference_depth = " +
                                              std::to_string(options.reference_depth));
  }
  options.weights = keys::ascending<double>(config, "error.rendering.weights");
  options.voxel_cuts = keys::ascending<double>(config, "error.rendering.voxel_cuts");
  options.seed = static_cast<std::uint64_t>(config.integer("error.rendering.seed"));
  options.repeats = keys::count(config, "error.rendering.repeats");
  if (frame.render.voxel_cut > 0.0) {
    config.fail("image.voxel_cut", "the study sets it itself, from error.rendering.voxel_cuts");
  }
  return options;
}

}  // namespace marti::studies::error
