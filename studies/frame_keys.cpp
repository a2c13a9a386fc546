#include "studies/frame_keys.h"

#include <limits>
#include <vector>

namespace marti::studies {

void declare_frame_keys(sim::Schema& schema) {
  schema.section("scene", "what is rendered");
  schema.text("scene.source", "teapot:12",
              "a procedural scene as name:size (see `marti scene list`), or a .gltf or .glb file relative to "
              "the configuration (with --set: to the current directory)");
  schema.text("scene.scene", "", "scene of the file, by index or name; empty: the file's default");
  schema.text("scene.camera", "", "camera of the file, by index or name; empty: the first");
  schema.integer("scene.frame", 0, {0, std::numeric_limits<std::uint32_t>::max()}, "",
                 "frame of the file's animation; only 0, the static pose");
  schema.section("image", "the image and the rays it takes");
  schema.integer("image.width", 512, {1, 32768}, "pixels", "columns");
  schema.integer("image.height", 512, {1, 32768}, "pixels", "rows");
  schema.integer("image.max_depth", 5, {1, processors::max_ray_depth}, "rays",
                 "longest chain of rays, the eye ray being 1; shadow rays do not count");
  schema.real("image.min_weight", 0.0, {0.0, 1.0}, "",
              "a ray that contributes less than this share of its pixel is not traced");
  schema.boolean("image.shadows", true, "trace shadow rays");
  schema.real("image.voxel_cut", 0.0, {0.0, 1'000'000.0}, "pixels",
              "octree: a cell that covers less than this many pixels on the screen is shaded as one voxel "
              "with averaged material; 0 is off and exact");
  schema.boolean("image.voxel_cut_reference", false,
                 "with the voxel cut: render the exact image too and report the difference");
  schema.section("structure", "the space subdivision");
  std::vector<std::string> kinds;
  for (const std::string_view kind : accel::structure_kinds()) {
    kinds.emplace_back(kind);
  }
  schema.choice(
      "structure.kind", "octree", kinds,
      "octree; bsp, a binary tree with the octree's planes; grid of equal cells; or none: every ray tests "
      "every primitive");
  schema.integer("structure.max_objects", 8, {1, 1'000'000}, "primitives",
                 "octree and bsp: a node with more than this many is split");
  schema.integer(
      "structure.max_level", 12, {1, 21}, "",
      "octree and bsp: deepest level of the octree, whose root is level 1; three levels of the binary "
      "tree make one of the octree");
  schema.real("structure.grid_density", 4.0, {0.001, 1000.0}, "cells",
              "grid: cells for each primitive, about");
  schema.section("host_machine", "the computer that runs the simulation");
  schema.size("host_machine.memory_limit", "8 GiB", {"1 MiB", "1024 TiB"},
              "refuse a frame whose image and work log would take more");
}

FrameConfig read_frame(sim::Config& config) {
  FrameConfig frame;
  frame.scene = config.text("scene.source");
  if (!config.where("scene.source").starts_with("--set")) {
    frame.open.base_directory = std::filesystem::path(config.name()).parent_path();
  }
  frame.open.gltf.scene = config.text("scene.scene");
  frame.open.gltf.camera = config.text("scene.camera");
  frame.open.gltf.frame = static_cast<std::uint32_t>(config.integer("scene.frame"));
  frame.render.width = static_cast<std::uint32_t>(config.integer("image.width"));
  frame.render.height = static_cast<std::uint32_t>(config.integer("image.height"));
  frame.render.max_depth = static_cast<std::uint32_t>(config.integer("image.max_depth"));
  frame.render.min_weight = config.real("image.min_weight");
  frame.render.shadows = config.boolean("image.shadows");
  frame.structure = config.choice_name("structure.kind");
  frame.render.voxel_cut = config.real("image.voxel_cut");
  if (frame.render.voxel_cut > 0.0) {
    if (frame.structure != "octree") {
      config.fail("image.voxel_cut",
                  "only an octree can be cut, not structure.kind = \"" + frame.structure + "\"");
    }
    frame.exact_too = config.boolean("image.voxel_cut_reference");
  } else {
    config.mark_unused_reason("image.voxel_cut_reference", "it has no effect with image.voxel_cut = 0",
                              "image.voxel_cut");
  }
  if (frame.structure == "octree" || frame.structure == "bsp") {
    accel::StructureOptions& options = frame.structure_options;
    options.octree.max_objects = static_cast<std::uint32_t>(config.integer("structure.max_objects"));
    options.octree.max_level = static_cast<std::uint32_t>(config.integer("structure.max_level"));
    options.bsp.max_objects = options.octree.max_objects;
    options.bsp.max_level = options.octree.max_level;
  } else if (frame.structure == "grid") {
    frame.structure_options.grid.density = config.real("structure.grid_density");
  }
  config.mark_unused_reason("structure", "it has no effect with structure.kind = \"" + frame.structure + "\"",
                            "structure.kind");
  frame.memory_limit = config.size("host_machine.memory_limit");
  return frame;
}

}  // namespace marti::studies
