#include "studies/error/error_keys.h"

#include "processors/program/render.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/other_commands.h"
#include "studies/run/run_result.h"

namespace marti::studies::error {

void declare_error_keys(sim::Schema& schema) {
  using processors::program::max_ray_depth;
  using processors::program::max_samples;
  schema.section(
      "error",
      "only for `marti study error`: the cheaper ways to a frame time, and the cheaper settings of "
      "the renderer, that are held against exact ones");
  schema.reals("error.within", {0.2, 0.05, 0.02, 0.01}, {1e-6, 1.0}, "fraction",
               "what is asked of `marti run --within`");
  schema.integers("error.divisors", {2, 4, 8}, {2, 32768}, "",
                  "smaller images: width and height of the image are divided by these");
  schema.integer("error.side", 64, {1, 32768}, "pixels",
                 "images are compared that are so small that their longer side has at most this many");
  schema.integers("error.samples", {1, 2, 4, 8, 16, 32, 64}, {1, max_samples / reference_factor}, "rays",
                  "samples of a pixel: for the frame time those below image.samples; for the image all, held "
                  "against 16 times the most");
  schema.integers("error.depths", {1, 2, 3, 4, 5, 6, 7, 8}, {1, max_ray_depth / 2}, "rays",
                  "longest chains of rays, in the place of image.max_depth, held against twice the longest");
  schema.reals(
      "error.weights", {0.001, 0.01, 0.05, 0.1, 0.2, 0.5}, {1e-9, 1.0}, "",
      "whitted: shares of a sample below which a ray is not traced, in the place of image.min_weight");
  schema.reals("error.voxel_cuts", {0.25, 1.0, 4.0, 16.0}, {1e-6, 1'000'000.0}, "pixels",
               "whitted, octree, no curved primitives: cuts, in the place of image.voxel_cut");
  schema.integer("error.repeats", 5, {1, 1000}, "", "times that each run time is measured");
}

sim::Schema error_schema() {
  sim::Schema schema;
  keys::declare_frame_keys(schema);
  keys::declare_machine_keys(schema);
  declare_error_keys(schema);
  keys::declare_sections_of_other_commands(schema);
  return schema;
}

ErrorConfig read_error(sim::Config& config) {
  ErrorConfig error;
  error.frame = keys::read_one_frame(config, keys::FrameUse::error);
  error.machine = keys::read_machine(config);
  error.within = keys::ascending<double>(config, "error.within");
  error.divisors = keys::ascending<std::uint32_t>(config, "error.divisors");
  error.side = keys::count(config, "error.side");
  error.samples = keys::ascending<std::uint32_t>(config, "error.samples");
  error.depths = keys::ascending<std::uint32_t>(config, "error.depths");
  error.weights = keys::ascending<double>(config, "error.weights");
  error.voxel_cuts = keys::ascending<double>(config, "error.voxel_cuts");
  error.repeats = keys::count(config, "error.repeats");
  if (error.frame.render.voxel_cut > 0.0) {
    config.fail("image.voxel_cut", "the study sets it itself, from error.voxel_cuts");
  }
  config.refuse_unused();
  run::refuse_beyond_memory(config, error.frame, error.machine);
  return error;
}

}  // namespace marti::studies::error
