#include "studies/run/frame_figures.h"

#include "sim/error.h"
#include "studies/figures/figure_parts.h"

namespace marti::studies::run {

namespace {

// A frame is described, not judged, and has each figure once.
figures::FigureParts::Description of_frame(std::string_view unit, std::string_view text) {
  return {unit, text, figures::Merge::one, figures::Better::neither};
}

void add(figures::FigureParts& parts, std::string_view name, std::string_view text,
         std::optional<std::uint64_t> count) {
  parts.add_count(name, of_frame("1", text), count);
}

void add_scene(figures::FigureParts& parts, const scenes::SceneFacts& scene) {
  add(parts, "polygons", "polygons of the source", scene.polygons);
  add(parts, "triangles", "triangles of the database", scene.triangles);
  add(parts, "spheres", "spheres of the database", scene.spheres);
  add(parts, "cylinders", "cylinders of the database", scene.cylinders);
  add(parts, "cones", "cones of the database", scene.cones);
  add(parts, "vertices", "vertices as stored", scene.vertices);
  add(parts, "materials", "materials of the scene", scene.materials);
  add(parts, "textures", "textures of the scene", scene.textures);
  add(parts, "lights", "lights of the scene", scene.lights);
}

void add_structure(figures::FigureParts& parts, const FunctionalRun& run,
                   const processors::program::WorkLog& log) {
  add(parts, "structure_nodes", "nodes of the tree; of a grid its header and its cells",
      log.topology.nodes.size());
  add(parts, "structure_entries", "object references in all leaves", log.topology.entries.size());
  add(parts, "structure_levels", "levels of an octree",
      run.levels.empty() ? std::nullopt : std::optional<std::uint64_t>(run.levels.size()));
}

void add_rays(figures::FigureParts& parts, const FunctionalRun& run) {
  const processors::program::Frame& frame = run.frame;
  add(parts, "width", "pixels of a row", frame.image.width);
  add(parts, "height", "rows of the image", frame.image.height);
  const bool cut = run.voxel_cut.has_value();
  for (std::size_t kind = 0; kind < processors::program::ray_kinds; ++kind) {
    const std::string name(processors::program::ray_kind_names[kind]);
    add(parts, name + "_rays", "rays of this kind traced", frame.rays.traced[kind]);
    add(parts, name + "_hits", "of these, hit something; a shadow ray: was blocked", frame.rays.hit[kind]);
    add(parts, name + "_voxels", "of these, saw a voxel",
        cut ? std::optional(frame.rays.voxels[kind]) : std::nullopt);
  }
  add(parts, "voxels", "averaged materials made for the voxel cut",
      cut ? std::optional<std::uint64_t>(frame.voxels) : std::nullopt);
}

void add_log(figures::FigureParts& parts, const processors::program::LogTotals& log) {
  parts.add_count("log_bytes",
                  {"byte", "words and pixel offsets of the program's work log", figures::Merge::one,
                   figures::Better::program},
                  log.bytes);
  add(parts, "log_branches", "branches visited", log.branches);
  add(parts, "log_transforms", "instances visited", log.transforms);
  add(parts, "log_leaves", "leaves visited", log.leaves);
  add(parts, "log_visits_95", "branches, instances, leaves and voxels that 95 % of the rays visit at most",
      log.visits_95);
  add(parts, "log_most_visits", "the most of these that a ray visits", log.most_visits);
  add(parts, "log_tests", "primitives tested", log.tests);
  add(parts, "log_lookups", "mailboxes looked up", log.lookups);
  add(parts, "log_shades", "points shaded", log.shades);
  add(parts, "log_lights", "contributions of lights added", log.lights);
  add(parts, "log_texels", "texels read", log.texels);
  add(parts, "log_cuts", "nodes taken as one voxel", log.cuts);
  add(parts, "log_any_hits", "hits of triangles with holes asked about", log.any_hits);
  add(parts, "log_passes", "small nodes too little covered for that", log.passes);
}

void add_row(figures::FigureParts& parts, const FunctionalRun& run, const processors::program::WorkLog& log) {
  add_scene(parts, run.scene);
  add_structure(parts, run, log);
  add_rays(parts, run);
  add_log(parts, run.totals);
}

}  // namespace

std::span<const figures::FigureEntry> frame_figures() {
  static const std::vector<figures::FigureEntry> figures = [] {
    std::vector<figures::FigureEntry> made;
    figures::FigureParts parts(&made);
    add_row(parts, {}, {});
    return made;
  }();
  return figures;
}

figures::Counts frame_counts(const FunctionalRun& run) {
  sim::ensure(run.frame.log != nullptr, "a frame has no work log");
  figures::FigureParts parts(nullptr);
  add_row(parts, run, *run.frame.log);
  return parts.take_values();
}

}  // namespace marti::studies::run
