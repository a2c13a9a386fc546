#include "studies/run/prepared_frame.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "accel/bsp.h"
#include "accel/bvh.h"
#include "accel/grid.h"
#include "accel/grid_match.h"
#include "accel/octree.h"
#include "accel/precision.h"
#include "sim/key_error.h"
#include "sim/shown.h"
#include "studies/host/image_file.h"
#include "studies/run/expected_times.h"
#include "studies/run/open_frame.h"

namespace marti::studies::run {

namespace {

constexpr std::string_view smaller_scene = "take a smaller scene";

// Notes that the tree was cut at its limit, so that it is not the tree that was asked for. Dividing a node
// never lessens the entries listed, so a limit once met stays met.
void note_cut_tree(const keys::FrameConfig& config, const accel::Structure& structure,
                   std::vector<std::string>& notes) {
  const accel::StructureOptions& options = config.structure_options;
  const std::uint64_t limit = structure.kind() == accel::Octree::kind_name ? options.octree.max_entries
                              : structure.kind() == accel::Bsp::kind_name  ? options.bsp.max_entries
                                                                           : 0;
  const std::size_t listed = structure.topology().entries.size();
  if (limit != 0 && listed >= limit) {
    notes.push_back("division stopped at " + std::to_string(listed) +
                    " listed primitives, so leaves above structure.max_level may list more than "
                    "structure.max_objects; lower the one or raise the other");
  }
}

// Requires memory for all textures, and for the largest once more, as its decoder returns it.
void require_textures(const keys::FrameConfig& config, const scenes::Scene& scene, std::uint64_t texels) {
  constexpr std::uint64_t bytes_a_texel = 4;
  std::uint64_t largest = 0;
  for (const scenes::Texture& texture : scene.textures) {
    largest = std::max(largest, texture.texels.empty() ? texture.size() : 0);
  }
  config.memory.require(scenes::host_bytes(scene) + bytes_a_texel * (texels + std::min(largest, texels)),
                        config.scene + ": the scene with its textures takes", smaller_scene);
}

scenes::Scene open_planned(const keys::FrameConfig& config, scenes::FileUse* file) {
  keys::FrameConfig planned = config;
  if (!config.keep.has(PlanItem::textures)) {
    planned.open.file.size_only = host::size_of_image;
  }
  planned.open.file.read_unused = config.keep.has(PlanItem::unreachable);
  return open_frame(planned, file);
}

}  // namespace

PreparedFrame::PreparedFrame(const keys::FrameConfig& config) : config_(config) {
  scenes::FileUse file;
  sim::begin_part(config.meter, "reading the scene");
  scenes::Scene scene = open_planned(config, &file);
  prepare_planned(std::move(scene), std::move(file));
}

PreparedFrame::PreparedFrame(const keys::FrameConfig& config, scenes::Scene scene, scenes::FileUse file)
    : config_(config) {
  prepare_planned(std::move(scene), std::move(file));
}

void PreparedFrame::prepare_planned(scenes::Scene scene, scenes::FileUse file) {
  config_.memory.require(scenes::host_bytes(scene) + scenes::host_bytes_of_facts(scene),
                         "the scene, sorted to be described, takes", smaller_scene);
  facts_ = facts_of_frame(scene, config_.render, config_.keep);
  facts_->file = std::move(file);
  run_.plan = make_plan(*facts_);
  run_.scene = scenes::facts_of(scene);
  require_textures(config_, scene,
                   is_left_out(run_.plan, PlanItem::textures) ? facts_->texels_needed : facts_->texels);
  sim::KeyError::reported_under(
      "scene.source",
      [&] { drop_parts(run_.plan, facts_->needs, host::decode_image, config_.open.file.strict, scene); },
      sim::shown(config_.scene) + ": ");
  own_scene_ = std::make_unique<const scenes::Scene>(std::move(scene));
  with_scene_keys([&] { prepare(*own_scene_); });
}

PreparedFrame::PreparedFrame(const keys::FrameConfig& config, const scenes::Scene& scene) : config_(config) {
  with_scene_keys([&] {
    run_.scene = scenes::facts_of(scene);
    prepare(scene);
  });
}

void PreparedFrame::prepare(const scenes::Scene& scene) {
  scene_ = &scene;
  if (config_.render.integrator == processors::program::Integrator::rays &&
      scene.rays.rays.size() > std::uint64_t{config_.render.width} * config_.render.height) {
    throw sim::KeyError("image.rays", "the file has more rays than when the configuration was read");
  }
  config_.memory.take(scenes::host_bytes(scene) + accel::TriangleSet::host_bytes(scene), "the scene takes",
                      smaller_scene);
  keys::give_memory(config_.memory, config_.structure_options);
  sim::begin_part(config_.meter, "building the " + config_.structure);
  if (config_.expected != nullptr) {
    config_.expected->scene_read(scene.triangles.size() + scene.quadrics.size());
  }
  triangles_ = std::make_shared<const accel::TriangleSet>(scene);
  structure_ = accel::make_structure(config_.structure, triangles_, config_.structure_options);
  // The work log has a copy of the tree.
  config_.memory.take(accel::host_bytes(*structure_) + accel::bytes_of(structure_->topology()),
                      "the structure and its copy in the work log take",
                      config_.structure == accel::Bvh::kind_name
                          ? smaller_scene
                          : "lower structure.max_level or raise structure.max_objects");
  if (facts_) {
    plan_structure(run_.plan, *facts_, *structure_);
    config_.render = planned_options(run_.plan, *facts_);
  }
  refuse_beyond_memory(config_, scene, *triangles_, *structure_);
  run_.notes = scene.notes;
  if (const auto* octree = dynamic_cast<const accel::StructureOf<accel::Octree>*>(structure_.get())) {
    run_.levels = octree->concrete().levels();
  } else if (const auto* grid = dynamic_cast<const accel::StructureOf<accel::Grid>*>(structure_.get())) {
    run_.structure_notes.push_back(accel::describe_resolution(grid->concrete()));
  } else if (const auto* bvh = dynamic_cast<const accel::StructureOf<accel::Bvh>*>(structure_.get())) {
    run_.structure_notes.push_back(fmt::format(
        "surface area heuristic: {:.2f} visits and tests of a ray that meets the root's box, if rays are "
        "spread evenly and hit nothing",
        bvh->concrete().sah_cost()));
  }
  note_cut_tree(config_, *structure_, run_.structure_notes);
  if (std::string need = accel::describe_need(accel::precision_need(*triangles_)); !need.empty()) {
    run_.notes.push_back(std::move(need));
  }
  config_.render.record = true;
}

processors::program::Frame PreparedFrame::trace(const processors::program::PixelSet* only,
                                                const processors::program::Frame* before) const {
  processors::program::RenderOptions options = config_.render;
  options.only = only;
  options.before = before;
  options.meter = config_.meter;
  sim::begin_part(config_.meter, "tracing", "rows", options.height);
  if (config_.expected != nullptr) {
    config_.expected->tracing_begins();
  }
  return with_scene_keys(
      [&] { return processors::program::render(*scene_, *triangles_, *structure_, options); });
}

FunctionalRun PreparedFrame::part(processors::program::Frame frame) const {
  FunctionalRun run = run_;
  run.frame = std::move(frame);
  run.totals = processors::program::totals_of(*run.frame.log);
  return run;
}

FunctionalRun PreparedFrame::finish(processors::program::Frame frame) const {
  FunctionalRun run = run_;
  run.frame = std::move(frame);
  std::vector<std::uint64_t> shades;
  run.totals = processors::program::totals_of(*run.frame.log, &shades);
  if (config_.expected != nullptr) {
    config_.expected->traced(run.totals);
  }
  run.image_hash = image_hash(run.frame.image);
  if (std::string note = host::note_of_infinities(run.frame.image); !note.empty()) {
    run.notes.push_back(std::move(note));
  }
  if (facts_) {
    check_plan(run.plan, facts_->needs, run.frame, shades);
  }
  if (config_.render.voxel_cut > 0.0) {
    VoxelReport& report = run.voxel_cut.emplace();
    report.use = database_use(*run.frame.log);
    if (config_.exact_too) {
      processors::program::RenderOptions options = config_.render;
      options.voxel_cut = 0.0;
      options.meter = config_.meter;
      sim::begin_part(config_.meter, "tracing without the voxel cut", "rows", options.height);
      processors::program::Frame exact = with_scene_keys(
          [&] { return processors::program::render(*scene_, *triangles_, *structure_, options); });
      report.exact = {
          std::move(exact.image), processors::program::totals_of(*exact.log), database_use(*exact.log), {}};
      report.exact->error = image_error(run.frame.image, report.exact->image);
    }
  }
  return run;
}

}  // namespace marti::studies::run
