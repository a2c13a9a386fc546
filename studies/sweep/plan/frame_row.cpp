#include <fmt/format.h>

#include "studies/sweep/plan/row_parts.h"
#include "studies/sweep/plan/sweep_row.h"

namespace marti::studies {

namespace {

void add_scene(RowParts& parts, const scenes::SceneFacts& scene) {
  parts.add_count("polygons", "1", "polygons of the source", scene.polygons);
  parts.add_count("triangles", "1", "triangles of the database", scene.triangles);
  parts.add_count("spheres", "1", "spheres of the database", scene.spheres);
  parts.add_count("cylinders", "1", "cylinders of the database", scene.cylinders);
  parts.add_count("cones", "1", "cones of the database", scene.cones);
  parts.add_count("vertices", "1", "vertices as stored", scene.vertices);
  parts.add_count("materials", "1", "materials of the scene", scene.materials);
  parts.add_count("textures", "1", "textures of the scene", scene.textures);
  parts.add_count("lights", "1", "lights of the scene", scene.lights);
}

void add_structure(RowParts& parts, const FunctionalRun& run, const processors::WorkLog& log) {
  parts.add_count("structure_nodes", "1", "nodes of the tree; of a grid its header and its cells",
                  log.topology.nodes.size());
  parts.add_count("structure_entries", "1", "object references in all leaves", log.topology.entries.size());
  parts.add_count("structure_levels", "1", "levels of an octree",
                  run.levels.empty() ? std::nullopt : std::optional<std::uint64_t>(run.levels.size()));
}

void add_rays(RowParts& parts, const FunctionalRun& run) {
  const processors::Frame& frame = run.frame;
  parts.add_count("width", "1", "pixels of a row", frame.image.width);
  parts.add_count("height", "1", "rows of the image", frame.image.height);
  const bool cut = run.voxel_cut.has_value();
  for (std::size_t kind = 0; kind < processors::ray_kinds; ++kind) {
    const std::string name(processors::ray_kind_names[kind]);
    parts.add_count(name + "_rays", "1", "rays of this kind traced", frame.rays.traced[kind]);
    parts.add_count(name + "_hits", "1", "of these, hit something; a shadow ray: was blocked",
                    frame.rays.hit[kind]);
    parts.add_count(name + "_voxels", "1", "of these, saw a voxel",
                    cut ? std::optional(frame.rays.voxels[kind]) : std::nullopt);
  }
  parts.add_count("voxels", "1", "averaged materials made for the voxel cut",
                  cut ? std::optional<std::uint64_t>(frame.voxels) : std::nullopt);
}

void add_log(RowParts& parts, const processors::LogTotals& log) {
  parts.add_count("log_bytes", "byte", "words and pixel offsets of the work log", log.bytes);
  parts.add_count("log_branches", "1", "branches visited", log.branches);
  parts.add_count("log_leaves", "1", "leaves visited", log.leaves);
  parts.add_count("log_tests", "1", "primitives tested", log.tests);
  parts.add_count("log_lookups", "1", "mailboxes looked up", log.lookups);
  parts.add_count("log_shades", "1", "points shaded", log.shades);
  parts.add_count("log_lights", "1", "contributions of lights added", log.lights);
  parts.add_count("log_texels", "1", "texels read", log.texels);
  parts.add_count("log_cuts", "1", "nodes taken as one voxel", log.cuts);
  parts.add_count("log_passes", "1", "small nodes too little covered for that", log.passes);
}

void add_row(RowParts& parts, const FunctionalRun& run, const processors::WorkLog& log) {
  add_scene(parts, run.scene);
  add_structure(parts, run, log);
  add_rays(parts, run);
  add_log(parts, run.totals);
}

}  // namespace

std::span<const Column> frame_columns() {
  static const std::vector<Column> columns = [] {
    std::vector<Column> made;
    RowParts parts(&made);
    add_row(parts, {}, {});
    return made;
  }();
  return columns;
}

FrameRow frame_row(const FunctionalRun& run, std::uint64_t scene_hash) {
  sim::ensure(run.frame.log != nullptr, "a frame of a sweep has no work log");
  RowParts parts(nullptr);
  add_row(parts, run, *run.frame.log);
  FrameRow row;
  row.counters = parts.take_values();
  row.scene = run.scene.name;
  row.scene_hash = fmt::format("{:016x}", scene_hash);
  row.image_hash = fmt::format("{:016x}", run.image_hash);
  row.hit_hash = fmt::format("{:016x}", run.frame.hit_hash);
  row.notes = run.notes;
  row.notes.insert(row.notes.end(), run.structure_notes.begin(), run.structure_notes.end());
  return row;
}

}  // namespace marti::studies
