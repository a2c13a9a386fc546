#include "studies/paper/paper_keys.h"

#include <algorithm>

#include "sim/shown.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/other_commands.h"

namespace marti::studies::paper {

namespace {

struct OwnKey {
  std::string_view key;
  std::string_view from;
};

// Keys of a run that the study sets itself, and the keys of the study that decide them.
constexpr OwnKey own_keys[] = {
    {"scene.source", "paper.scenes and paper.run_scenes"},
    {"scene.scene", "paper.scenes and paper.run_scenes"},
    {"scene.camera", "paper.scenes and paper.run_scenes"},
    {"scene.eye", "paper.scenes and paper.run_scenes"},
    {"scene.look_at", "paper.scenes and paper.run_scenes"},
    {"scene.up", "paper.scenes and paper.run_scenes"},
    {"scene.field_of_view", "paper.scenes and paper.run_scenes"},
    {"scene.animation", "paper.scenes and paper.run_scenes"},
    {"frames.count", "paper.scenes and paper.run_scenes"},
    {"frames.first", "paper.scenes and paper.run_scenes"},
    {"frames.rate", "paper.scenes and paper.run_scenes"},
    {"image.max_depth", "paper.run_depths"},
};

std::vector<PaperRun> read_runs(const sim::Config& config) {
  const std::vector<std::string> scenes = config.texts("paper.run_scenes");
  const std::vector<std::int64_t> depths = config.integers("paper.run_depths");
  if (scenes.size() != depths.size()) {
    config.fail("paper.run_depths", "must have one depth for each of the " + std::to_string(scenes.size()) +
                                        " scenes of paper.run_scenes, not " + std::to_string(depths.size()));
  }
  std::vector<PaperRun> runs;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    PaperRun run{scenes[i], static_cast<std::uint32_t>(depths[i])};
    if (std::ranges::find(runs, run) != runs.end()) {
      config.fail("paper.run_scenes", "names " + sim::shown(name_of(run)) + " twice");
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace

std::string name_of(const PaperRun& run) { return run.scene + " at depth " + std::to_string(run.depth); }

keys::FrameConfig PaperConfig::frame_of(const PaperRun& run) const {
  keys::FrameConfig own = frame;
  own.scene = run.scene;
  own.render.max_depth = run.depth;
  return own;
}

void declare_paper_keys(sim::Schema& schema) {
  schema.section(
      "paper",
      "only for `marti study paper`, which sets scene.* and image.max_depth itself and wants an octree");
  schema.texts("paper.scenes", {"gears:2", "tetra:6", "teapot:4:pot", "teapot:12:pot", "large"},
               "scenes whose octree and BSP tree are compared (table 1)");
  schema.texts("paper.run_scenes", {"gears:2", "teapot:12:pot", "teapot:12:pot", "large"},
               "scenes to render, whose memory and accesses are counted level by level (figures 2 and 3)");
  schema.integers("paper.run_depths", {2, 2, 4, 2}, {1, processors::program::max_ray_depth}, "rays",
                  "longest chain of rays in each of them, the eye ray being 1");
  schema.reals(
      "paper.rules", {3.0, 10.0}, {0.0, 1e6}, "",
      "k of the rules \"stop at the first level with more than k times as many leaves as other nodes\"");
}

sim::Schema paper_schema() {
  sim::Schema schema;
  keys::declare_frame_keys(schema);
  declare_paper_keys(schema);
  keys::declare_sections_of_other_commands(schema);
  return schema;
}

PaperConfig read_paper(sim::Config& config) {
  PaperConfig paper;
  for (const OwnKey& own : own_keys) {
    if (config.given(own.key)) {
      config.fail(own.key, "the study sets it itself, from " + std::string(own.from));
    }
  }
  paper.frame = keys::read_frame(config, keys::FrameUse::paper);
  if (paper.frame.render.voxel_cut > 0.0) {
    config.fail("image.voxel_cut", "the study renders exact images");
  }
  if (paper.frame.structure != "octree") {
    config.fail("structure.kind", "the study builds octrees, and BSP trees beside them");
  }
  paper.scenes = keys::study_scenes(config, "paper.scenes");
  paper.runs = read_runs(config);
  paper.rules = config.reals("paper.rules");
  config.refuse_unused();
  return paper;
}

}  // namespace marti::studies::paper
