#include "studies/run/functional_run.h"

#include <algorithm>
#include <bit>
#include <string_view>
#include <utility>

#include "accel/precision.h"
#include "accel/structure.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "sim/shown.h"
#include "studies/host/image_file.h"
#include "studies/run/open_frame.h"
#include "studies/run/plan/make_plan.h"

namespace marti::studies {

namespace {

// An image of at most this many pixels a side is rendered without estimating its memory first,
constexpr std::uint32_t sample_side = 64;
// if it also has at most this many samples a pixel.
constexpr std::uint32_t sample_rays = 4;
constexpr std::string_view smaller_scene = "take a smaller scene";

}  // namespace

// FNV-1a (Fowler, Noll, Vo) over the bits of all pixels.
std::uint64_t image_hash(const processors::Image& image) {
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
void refuse_beyond_memory(const FrameConfig& config, const scenes::Scene& scene,
                          const accel::TriangleSet& triangles, const accel::Structure& structure) {
  processors::RenderOptions sample = config.render;
  const std::uint32_t longer = std::max(sample.width, sample.height);
  if (longer <= sample_side && sample.samples <= sample_rays) {
    return;
  }
  if (longer > sample_side) {
    sample.width = std::max(1U, sample.width * sample_side / longer);
    sample.height = std::max(1U, sample.height * sample_side / longer);
  }
  sample.samples = std::min(sample.samples, sample_rays);
  sample.record = true;
  sample.voxel_cut = 0.0;  // a coarse sample would cut more than the frame
  const processors::Frame frame = processors::render(scene, triangles, structure, sample);
  const double pixels = static_cast<double>(config.render.width) * config.render.height;
  const double frames = config.exact_too ? 2.0 : 1.0;
  const double bytes = frames * static_cast<double>(processors::totals_of(*frame.log).bytes) /
                           (static_cast<double>(sample.width) * sample.height * sample.samples) * pixels *
                           config.render.samples * 2.0 +
                       frames * pixels * sizeof(glm::vec3);
  config.memory.require(static_cast<std::uint64_t>(std::min(bytes, 9e18)),
                        "the image and its work log may take",
                        "lower image.width, image.height, image.samples or image.max_depth");
}

namespace {

// Notes that the tree was cut at its limit, so that it is not the tree that was asked for. Dividing a node
// never lessens the entries listed, so a limit once met stays met.
void note_cut_tree(const FrameConfig& config, const accel::Structure& structure,
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

// Structures that the frame does not use, built only if the user wants plan item `structures` kept.
std::vector<std::unique_ptr<accel::Structure>> kept_structures(
    const FrameConfig& config, const std::shared_ptr<const accel::TriangleSet>& triangles) {
  std::vector<std::unique_ptr<accel::Structure>> kept;
  for (const std::string_view kind : accel::structure_kinds()) {
    if (config.keep.has(PlanItem::structures) && kind != config.structure) {
      kept.push_back(accel::make_structure(kind, triangles, config.structure_options));
    }
  }
  return kept;
}

// Requires memory for all textures, and for the largest once more, as its decoder returns it.
void require_textures(const FrameConfig& config, const scenes::Scene& scene, std::uint64_t texels) {
  constexpr std::uint64_t bytes_a_texel = 4;
  std::uint64_t largest = 0;
  for (const scenes::Texture& texture : scene.textures) {
    largest = std::max(largest, texture.texels.empty() ? texture.size() : 0);
  }
  config.memory.require(scenes::host_bytes(scene) + bytes_a_texel * (texels + std::min(largest, texels)),
                        config.scene + ": the scene with its textures takes", smaller_scene);
}

// Renders a frame of an open scene; by the run's plan if `facts` is not null.
FunctionalRun render_and_record(const FrameConfig& config, scenes::SceneFacts scene_facts,
                                const scenes::Scene& scene, const PlanFacts* facts, FunctionalRun run) {
  FrameConfig planned = config;
  planned.memory.take(scenes::host_bytes(scene) + accel::TriangleSet::host_bytes(scene), "the scene takes",
                      smaller_scene);
  give_memory(planned.memory, planned.structure_options);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const std::unique_ptr<accel::Structure> structure =
      accel::make_structure(config.structure, triangles, planned.structure_options);
  const std::vector<std::unique_ptr<accel::Structure>> others = kept_structures(planned, triangles);
  // The work log has a copy of the tree.
  planned.memory.take(accel::host_bytes(*structure) + accel::bytes_of(structure->topology()),
                      "the structure and its copy in the work log take",
                      "lower structure.max_level or raise structure.max_objects");
  if (facts != nullptr) {
    plan_structure(run.plan, *facts, *structure);
    planned.render = planned_options(run.plan, *facts);
  }
  refuse_beyond_memory(planned, scene, *triangles, *structure);

  run.scene = std::move(scene_facts);
  run.notes = scene.notes;
  if (const auto* octree = dynamic_cast<const accel::StructureOf<accel::Octree>*>(structure.get())) {
    run.levels = octree->concrete().levels();
  } else if (const auto* grid = dynamic_cast<const accel::StructureOf<accel::Grid>*>(structure.get())) {
    run.structure_notes.push_back(accel::describe_resolution(grid->concrete()));
  }
  note_cut_tree(config, *structure, run.structure_notes);
  if (std::string need = accel::describe_need(accel::precision_need(*triangles)); !need.empty()) {
    run.notes.push_back(std::move(need));
  }
  processors::RenderOptions options = planned.render;
  options.record = true;
  run.frame = processors::render(scene, *triangles, *structure, options);
  std::vector<std::uint64_t> shades;
  run.totals = processors::totals_of(*run.frame.log, &shades);
  run.image_hash = image_hash(run.frame.image);
  if (std::string note = note_of_infinities(run.frame.image); !note.empty()) {
    run.notes.push_back(std::move(note));
  }
  if (facts != nullptr) {
    count_saved(run.plan, facts->needs, scene, run.frame, run.totals, shades);
  }
  if (options.voxel_cut > 0.0) {
    VoxelReport& report = run.voxel_cut.emplace();
    report.use = database_use(*run.frame.log);
    if (config.exact_too) {
      options.voxel_cut = 0.0;
      processors::Frame exact = processors::render(scene, *triangles, *structure, options);
      report.exact = {
          std::move(exact.image), processors::totals_of(*exact.log), database_use(*exact.log), {}};
      report.exact->error = image_error(run.frame.image, report.exact->image);
    }
  }
  return run;
}

}  // namespace

FunctionalRun run_functional(const FrameConfig& config) {
  scenes::OpenOptions open = config.open;
  if (!config.keep.has(PlanItem::textures)) {
    open.gltf.size_only = size_of_image;
  }
  open.gltf.read_unused = config.keep.has(PlanItem::unreachable);
  scenes::FileUse file;
  FrameConfig planned = config;
  planned.open = std::move(open);
  scenes::Scene scene = open_frame(planned, &file);
  return run_planned(config, std::move(scene), std::move(file));
}

FunctionalRun run_planned(const FrameConfig& config, scenes::Scene scene, scenes::FileUse file) {
  config.memory.require(scenes::host_bytes(scene) + scenes::host_bytes_of_facts(scene),
                        "the scene, sorted to be described, takes", smaller_scene);
  PlanFacts facts = facts_of_frame(scene, config.render, config.structure, config.keep);
  facts.file = std::move(file);
  FunctionalRun run;
  run.plan = make_plan(facts);
  scenes::SceneFacts scene_facts = scenes::facts_of(scene);
  require_textures(config, scene,
                   is_left_out(run.plan, PlanItem::textures) ? facts.texels_needed : facts.texels);
  sim::KeyError::reported_under(
      "scene.source", [&] { drop_parts(run.plan, facts.needs, decode_image, scene); },
      sim::shown(config.scene) + ": ");
  return with_scene_keys(
      [&] { return render_and_record(config, std::move(scene_facts), scene, &facts, std::move(run)); });
}

FunctionalRun run_functional(const FrameConfig& config, const scenes::Scene& scene) {
  return with_scene_keys(
      [&] { return render_and_record(config, scenes::facts_of(scene), scene, nullptr, {}); });
}

}  // namespace marti::studies
