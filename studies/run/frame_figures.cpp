#include "studies/run/frame_figures.h"

#include "sim/error.h"
#include "studies/figures/figure_parts.h"

namespace marti::studies::run {

namespace {

void add_scene(figures::FigureParts& parts, const scenes::SceneFacts& scene) {
  parts.add_count("polygons", {"1", "polygons of the source", figures::Merge::one, figures::Better::neither},
                  scene.polygons);
  parts.add_count("triangles",
                  {"1", "triangles of the database", figures::Merge::one, figures::Better::neither},
                  scene.triangles);
  parts.add_count("spheres", {"1", "spheres of the database", figures::Merge::one, figures::Better::neither},
                  scene.spheres);
  parts.add_count("cylinders",
                  {"1", "cylinders of the database", figures::Merge::one, figures::Better::neither},
                  scene.cylinders);
  parts.add_count("cones", {"1", "cones of the database", figures::Merge::one, figures::Better::neither},
                  scene.cones);
  parts.add_count("vertices", {"1", "vertices as stored", figures::Merge::one, figures::Better::neither},
                  scene.vertices);
  parts.add_count("materials", {"1", "materials of the scene", figures::Merge::one, figures::Better::neither},
                  scene.materials);
  parts.add_count("textures", {"1", "textures of the scene", figures::Merge::one, figures::Better::neither},
                  scene.textures);
  parts.add_count("lights", {"1", "lights of the scene", figures::Merge::one, figures::Better::neither},
                  scene.lights);
}

void add_structure(figures::FigureParts& parts, const FunctionalRun& run,
                   const processors::program::WorkLog& log) {
  parts.add_count("structure_nodes",
                  {"1", "nodes of the tree; of a grid its header and its cells", figures::Merge::one,
                   figures::Better::neither},
                  log.topology.nodes.size());
  parts.add_count("structure_entries",
                  {"1", "object references in all leaves", figures::Merge::one, figures::Better::neither},
                  log.topology.entries.size());
  parts.add_count("structure_levels",
                  {"1", "levels of an octree", figures::Merge::one, figures::Better::neither},
                  run.levels.empty() ? std::nullopt : std::optional<std::uint64_t>(run.levels.size()));
}

void add_rays(figures::FigureParts& parts, const FunctionalRun& run) {
  const processors::program::Frame& frame = run.frame;
  parts.add_count("width", {"1", "pixels of a row", figures::Merge::one, figures::Better::neither},
                  frame.image.width);
  parts.add_count("height", {"1", "rows of the image", figures::Merge::one, figures::Better::neither},
                  frame.image.height);
  const bool cut = run.voxel_cut.has_value();
  for (std::size_t kind = 0; kind < processors::program::ray_kinds; ++kind) {
    const std::string name(processors::program::ray_kind_names[kind]);
    parts.add_count(name + "_rays",
                    {"1", "rays of this kind traced", figures::Merge::one, figures::Better::neither},
                    frame.rays.traced[kind]);
    parts.add_count(name + "_hits",
                    {"1", "of these, hit something; a shadow ray: was blocked", figures::Merge::one,
                     figures::Better::neither},
                    frame.rays.hit[kind]);
    parts.add_count(name + "_voxels",
                    {"1", "of these, saw a voxel", figures::Merge::one, figures::Better::neither},
                    cut ? std::optional(frame.rays.voxels[kind]) : std::nullopt);
  }
  parts.add_count(
      "voxels",
      {"1", "averaged materials made for the voxel cut", figures::Merge::one, figures::Better::neither},
      cut ? std::optional<std::uint64_t>(frame.voxels) : std::nullopt);
}

void add_log(figures::FigureParts& parts, const processors::program::LogTotals& log) {
  parts.add_count(
      "log_bytes",
      {"byte", "words and pixel offsets of the work log", figures::Merge::one, figures::Better::neither},
      log.bytes);
  parts.add_count("log_branches", {"1", "branches visited", figures::Merge::one, figures::Better::neither},
                  log.branches);
  parts.add_count("log_leaves", {"1", "leaves visited", figures::Merge::one, figures::Better::neither},
                  log.leaves);
  parts.add_count("log_tests", {"1", "primitives tested", figures::Merge::one, figures::Better::neither},
                  log.tests);
  parts.add_count("log_lookups", {"1", "mailboxes looked up", figures::Merge::one, figures::Better::neither},
                  log.lookups);
  parts.add_count("log_shades", {"1", "points shaded", figures::Merge::one, figures::Better::neither},
                  log.shades);
  parts.add_count("log_lights",
                  {"1", "contributions of lights added", figures::Merge::one, figures::Better::neither},
                  log.lights);
  parts.add_count("log_texels", {"1", "texels read", figures::Merge::one, figures::Better::neither},
                  log.texels);
  parts.add_count("log_cuts",
                  {"1", "nodes taken as one voxel", figures::Merge::one, figures::Better::neither}, log.cuts);
  parts.add_count(
      "log_passes",
      {"1", "small nodes too little covered for that", figures::Merge::one, figures::Better::neither},
      log.passes);
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
