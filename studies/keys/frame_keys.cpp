#include "studies/keys/frame_keys.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "memory/layout.h"
#include "processors/walk/node_order.h"
#include "scenes/given_rays.h"
#include "scenes/scene_list.h"
#include "sim/config_errors.h"
#include "sim/key_error.h"
#include "sim/mapped.h"
#include "sim/shown.h"
#include "sim/units.h"
#include "studies/host/image_file.h"
#include "studies/keys/key_parts.h"

namespace marti::studies::keys {

namespace {

void read_tree_limits(const sim::Config& config, accel::StructureOptions& options) {
  options.octree.max_objects = count(config, "structure.max_objects");
  options.octree.max_level = count(config, "structure.max_level");
  options.bsp.max_objects = options.octree.max_objects;
  options.bsp.max_level = options.octree.max_level;
}

void read_bvh(const sim::Config& config, accel::BvhOptions& options) {
  options.node = config.choice_as<accel::BvhNodeKind>("structure.bvh_children");
  options.max_objects = count(config, "structure.bvh_leaf");
  options.bins = count(config, "structure.bvh_bins");
  const std::uint32_t largest = accel::bvh_largest_leaf(options.node);
  if (options.max_objects > largest) {
    config.fail("structure.bvh_leaf",
                "must be at most " + std::to_string(largest) + " with structure.bvh_children = \"" +
                    config.choice_name("structure.bvh_children") +
                    "\", whose records count a leaf's primitives in " +
                    (options.node == accel::BvhNodeKind::six ? "four" : "three") + " bits");
  }
}

/// What other programs call these structures.
constexpr std::array<sim::RenamedChoice, 6> other_structures = {{{"kdtree", "bsp"},
                                                                 {"kd-tree", "bsp"},
                                                                 {"kd", "bsp"},
                                                                 {"uniform", "grid"},
                                                                 {"aabb", "bvh"},
                                                                 {"brute", "none"}}};

void read_structure(sim::Config& config, FrameConfig& frame) {
  accel::StructureOptions& options = frame.structure_options;
  frame.structure = config.choice_name("structure.kind");
  frame.render.mailboxes = config.boolean("structure.mailboxes");
  std::string how = "structure.kind = \"" + frame.structure + "\"";
  if (frame.structure == "octree") {
    read_tree_limits(config, options);
  } else if (frame.structure == "bsp") {
    read_tree_limits(config, options);
    options.bsp.walk = config.choice_as<accel::BspWalk>("structure.bsp_walk");
  } else if (frame.structure == "bvh") {
    read_bvh(config, options.bvh);
    frame.open.file.instances = config.choice_as<scenes::Instances>("structure.instances");
  } else if (frame.structure == "grid") {
    options.grid_match = config.choice_as<accel::GridMatch>("structure.grid_resolution");
    if (options.grid_match == accel::GridMatch::density) {
      options.grid.density = config.real("structure.grid_density");
    } else {
      read_tree_limits(config, options);
    }
    how += " and structure.grid_resolution = \"" + config.choice_name("structure.grid_resolution") + "\"";
  }
  config.mark_unused_reason("structure", "it has no effect with " + how, "structure.kind");
}

// What the frame depends on if it is for SIMT nodes and of a bvh. All machines that are tried on its log may
// prefetch what waits on stacks then.
void read_for_units(sim::Config& config, FrameConfig& frame) {
  const auto value = [&](std::string_view key) { return value_if_declared(config, key); };
  if (value("node.kind") != "simt") {
    return;
  }
  processors::program::RenderOptions& render = frame.render;
  render.ray_words = value("rt.sort") == "direction" || value("rt.sort") == "origin";
  if (frame.structure != "bvh") {
    return;
  }
  render.entered = true;
  render.meets = value("rt.share") == "warp";
  if (value("rt.order") == accel::walk_order_names.front()) {
    return;  // it is read with the machine, so that the frame is that of other nodes, too
  }
  render.order = config.choice_as<accel::WalkOrder>("rt.order");
  if (render.order == accel::WalkOrder::treelet_first) {
    if (config.choice_as<memory::NodeOrder>("layout.node_order") != memory::NodeOrder::treelets) {
      config.fail("rt.order",
                  "\"treelet_first\" needs nodes that lie in treelets; set layout.node_order = \"treelets\"");
    }
    memory::LayoutConfig layout;
    layout.node_bytes = accel::bvh_record_bytes(frame.structure_options.bvh.node);
    layout.record_alignment =
        std::max(1U, static_cast<std::uint32_t>(config.size("layout.record_alignment")));
    layout.treelet_bytes = static_cast<std::uint32_t>(config.size("layout.treelet"));
    render.treelet_records = processors::walk::treelet_records(layout);
  }
}

}  // namespace

processors::program::RenderOptions made_small(processors::program::RenderOptions options, double side) {
  const double factor = std::min(1.0, side / std::max(options.width, options.height));
  // Whole pixels; the smallest fraction is far above the rounding error that is added.
  const auto whole = [&](std::uint32_t pixels) { return static_cast<std::uint32_t>(pixels * factor + 1e-9); };
  const auto small = [&](std::uint32_t pixels) { return std::max(1U, whole(pixels)); };
  options.width = small(options.width);
  options.height = small(options.height);
  if (std::optional<processors::program::Window>& window = options.window) {
    window->image_width = std::max(options.width, small(window->image_width));
    window->image_height = std::max(options.height, small(window->image_height));
    window->left = std::min(whole(window->left), window->image_width - options.width);
    window->top = std::min(whole(window->top), window->image_height - options.height);
  }
  return options;
}

std::string size_text(const processors::program::RenderOptions& options) {
  const std::optional<processors::program::Window>& window = options.window;
  return fmt::format("{} x {}", options.width, options.height) +
         (window ? fmt::format(" at ({}, {}) of {} x {}", window->left, window->top, window->image_width,
                               window->image_height)
                 : "");
}

void declare_frame_keys(sim::Schema& schema) {
  schema.section("scene", "what is rendered");
  schema.text_or_composite(
      "scene.source", "teapot:12",
      "a procedural scene as name:size (see `marti scene list`), or a .gltf, .glb, .obj, .ply or .pbrt file, "
      "or a folder of such files with a slash at its end, relative to the configuration (with --set: to the "
      "current directory); or a list of these as one scene, also of .camera files, in which an entry may be "
      "a "
      "table of source and scale, rotate, translate or matrix (docs/scenes.md)");
  schema.text("scene.log", "",
              "a work log that `marti run --save-log` has written, which is read in the place of the scene; "
              "keys of scene, frames, image and structure are those of the log (docs/scenes.md)");
  schema.text("scene.scene", "", "scene of the file, by index or name; empty: the file's default");
  schema.text("scene.camera", "", "camera of the file, by index or name; empty: the first");
  schema.reals("scene.eye", {}, {-1e30, 1e30}, "",
               "where the eye is, three coordinates; empty: where the camera is, of a file without one, "
               "where all is seen");
  schema.reals("scene.look_at", {}, {-1e30, 1e30}, "",
               "the point in the middle of the image, three coordinates; empty: the camera's");
  schema.reals("scene.up", {}, {-1e30, 1e30}, "",
               "the direction that is up, three coordinates; empty: the camera's");
  schema.real("scene.field_of_view", 0.0, {0.0, 179.9}, "degrees",
              "angle between the lower and the upper edge of the image; 0: the camera's");
  schema.reals("scene.sky", {}, {0.0, 1e9}, "",
               "colour of a sky, linear red, green and blue: what is seen where there is nothing, and the "
               "ambient light, by which surfaces that the whole sky would reach look the same as paths show "
               "them; empty: the scene's own background and ambient light");
  schema.reals("scene.sun", {}, {-1e30, 1e30}, "",
               "the direction towards a sun, three coordinates: a directional light beside the scene's own; "
               "empty: none");
  schema.reals("scene.sun_color", {1.0, 1.0, 1.0}, {0.0, 1e9}, "",
               "colour of the sun, linear red, green and blue: a matt white surface that faces the sun has "
               "this colour");
  schema.text("scene.animation", "",
              "animation of the file that plays, by index or name; empty: the first, if there is one; none: "
              "the file's static pose");
  schema.choice("scene.default_light", "auto", names(scenes::default_light_names),
                "auto: a file without lights, if there is no sun, gets one over the camera's shoulder and "
                "ambient light, with image.integrator = \"path\" or \"shadow\" only if no triangle of it "
                "emits light, and with \"path\" if there is no sky; always: every scene gets them beside its "
                "own; never: none does");
  schema.boolean("scene.strict", false,
                 "refuse a file with parts that are missing or that its format does not allow; else what can "
                 "be replaced is, with a note (docs/scenes.md)");
  schema.section("frames", "the frames of an animated scene");
  schema.integer("frames.count", 1, {1, 1'000'000}, "frames", "how many; `marti run` renders one");
  schema.integer("frames.first", 0, {0, 1'000'000'000}, "",
                 "number of the first; frame i shows the animation at i / rate seconds");
  schema.real("frames.rate", 24.0, {1e-6, 1e6}, "frames a second", "frames of a second of the animation");
  schema.boolean(
      "frames.verify", true,
      "`marti study frames` only: render every frame once more with a tree built from nothing, and "
      "compare the images");
  schema.section("image", "the image and the rays it takes");
  schema.integer("image.width", 512, {1, 32768}, "pixels", "columns");
  schema.integer("image.height", 512, {1, 32768}, "pixels", "rows");
  schema.integers("image.region", {}, {0, 32768}, "pixels",
                  "window of the image that is rendered: [column and row of its upper left pixel, width, "
                  "height], from 0; its pixels are those of the whole image; empty: all of it");
  schema.choice(
      "image.integrator", "whitted", names(processors::program::integrator_names),
      "whitted: lights, mirror images and refractions; path: path tracing, also light that surfaces "
      "scatter to each other, emissive triangles as lights, noise that more samples lessen; rays: no image, "
      "but what the rays of image.rays hit; shadow, occlusion: from what camera rays hit, "
      "image.secondary_rays rays to points of the lights, or a short way into the hemisphere, each ended by "
      "any hit, and nothing else; gaussians: those of 3D Gaussian splatting, from front to back "
      "(docs/scenes.md)");
  schema.text("image.rays", "",
              "rays: a NumPy file (.npy), relative to the configuration (with --set: to the current "
              "directory), of float32 or float64 with a row for each ray: origin (3), least distance, "
              "direction (3), greatest distance, and, where there is a ninth column, 0 for the closest hit "
              "or 1 for any (docs/scenes.md)");
  schema.integer("image.secondary_rays", 4, {1, processors::program::max_secondary_rays}, "rays",
                 "shadow, occlusion: rays from each point that a camera ray hits");
  schema.real("image.occlusion_distance", 0.1, {0.0, 1e6}, "",
              "occlusion: how far the rays reach, as a part of the largest side of the scene's box; 0: "
              "without end");
  schema.integer("image.nearest_hits", 16, {1, processors::program::max_nearest_hits}, "",
                 "gaussians: how many a ray finds in order before it is traced anew behind the last of them");
  schema.integer("image.max_depth", 5, {1, processors::program::max_ray_depth}, "rays",
                 "longest chain of rays, the eye ray being 1; shadow rays do not count");
  schema.real("image.min_weight", 0.0, {0.0, 1.0}, "",
              "whitted: a ray that contributes less than this share of its sample is not traced");
  schema.integer(
      "image.samples", 1, {1, processors::program::max_samples}, "rays",
      "camera rays of a pixel: one through its centre, or several through jittered points of a grid");
  schema.integer("image.seed", 1, {0, std::numeric_limits<std::int64_t>::max()}, "",
                 "seed of the points of several samples and of paths");
  schema.boolean("image.shadows", true, "trace shadow rays");
  schema.real("image.voxel_cut", 0.0, {0.0, 1'000'000.0}, "pixels",
              "octree: a cell that covers less than this many pixels on the screen is shaded as one voxel "
              "with averaged material; 0 is off and exact");
  schema.boolean("image.voxel_cut_reference", false,
                 "with the voxel cut: render the exact image too and report the difference");
  schema.section("structure", "the space subdivision");
  const std::vector<std::string> kinds =
      sim::mapped(accel::structure_kinds(), [&](const std::string_view kind) { return std::string(kind); });
  schema.choice("structure.kind", "octree", kinds,
                "octree; bsp, a binary tree with the octree's planes; grid of equal cells; bvh, boxes around "
                "primitives within boxes (docs/internals/bvh.md); or none: every ray tests every primitive",
                other_structures);
  schema.integer("structure.max_objects", 8, {1, 1'000'000}, "primitives",
                 "octree and bsp: a node with more than this many is split");
  schema.integer(
      "structure.max_level", 12, {1, 21}, "",
      "octree and bsp: deepest level of the octree, whose root is level 1; three levels of the binary "
      "tree make one of the octree");
  schema.real("structure.grid_density", 4.0, {0.001, 1000.0}, "cells",
              "grid: cells for each primitive, about");
  schema.choice(
      "structure.grid_resolution", "density", names(accel::grid_match_names),
      "grid: from the density; as many cells as an octree of the same max_objects and max_level has "
      "nodes, about; or cells as small as its smallest. At most 4 Mi cells");
  schema.choice("structure.bsp_walk", "recursive", names(accel::bsp_walk_names),
                "bsp: from the root down, or from leaf to leaf by a point pushed through their faces and "
                "located from the root");
  schema.choice("structure.bvh_children", "8", names(accel::bvh_node_names),
                "bvh: most children of a node, whose record has 32 bytes for each; 6: 64 bytes in all, "
                "8_quantised: 80, with boxes in bytes");
  schema.integer("structure.bvh_leaf", 3, {1, accel::bvh_largest_leaf(accel::BvhNodeKind::two)}, "primitives",
                 "bvh: most that a leaf lists; 6: at most 15, 8_quantised: at most 3");
  schema.integer("structure.bvh_bins", 32, {2, accel::bvh_most_bins}, "",
                 "bvh: intervals of each axis between which the builder looks for a node's best split");
  schema.choice(
      "structure.instances", "auto", names(scenes::instances_names),
      "bvh: meshes that nodes of a glTF file share, and the proxies of Gaussians, are copied for each, "
      "or kept once, in a tree of their own below a tree of instances; auto: kept where copies would be more "
      "than 4 million "
      "triangles");
  schema.boolean("structure.mailboxes", false,
                 "no ray tests a primitive twice: each remembers the last ray, in a word of the node's own");
  schema.section("host_machine", "the computer that runs the simulation");
  schema.size(
      "host_machine.memory_limit", "0 B", {"0 B", "1024 TiB"},
      "refuse what would take more memory: scene, structure, work log, machine, plan of a sweep; 0: three "
      "quarters of what the host, the container and `ulimit -v` allow; else at least 1 MiB");
}

void give_memory(const sim::MemoryBudget& memory, accel::StructureOptions& options) {
  options.octree.memory = memory;
  options.bsp.memory = memory;
  options.grid.memory = memory;
  options.bvh.memory = memory;
}

sim::MemoryBudget read_memory(const sim::Config& config, std::uint64_t processes) {
  constexpr std::int64_t least = std::int64_t{1} << 20U;
  const std::int64_t limit = config.size("host_machine.memory_limit");
  if (limit == 0) {
    return sim::MemoryBudget(sim::default_memory_limit(processes));
  }
  if (limit < least) {
    config.fail(
        "host_machine.memory_limit",
        sim::print_size(limit) + " is less than 1 MiB; 0 stands for three quarters of the host's memory");
  }
  return sim::MemoryBudget(static_cast<std::uint64_t>(limit), true);
}

std::filesystem::path directory_of(const sim::Config& config, std::string_view key) {
  const std::string where = config.where(key);
  const bool of_the_command = where.starts_with("--set") || where.starts_with("--axis");
  return of_the_command ? std::filesystem::path() : std::filesystem::path(config.name()).parent_path();
}

namespace {

void refuse_missing(const sim::Config& config, std::string_view key, const std::filesystem::path& path,
                    std::string_view what, const std::string& entry = {}) {
  if (std::error_code error; !std::filesystem::exists(path, error)) {
    config.fail(key, entry + "there is no " + std::string(what) + " " + sim::shown(path.string()) +
                         "; one that a configuration names is looked for beside it, one given with "
                         "--set or --axis in the current directory");
  }
}

/// Of a list, all entries, before any of them is read.
void refuse_missing_scenes(const sim::Config& config, const FrameConfig& frame) {
  constexpr std::string_view key = "scene.source";
  const auto refuse = [&](const std::string& source, const std::string& entry) {
    if (scenes::names_a_file(source)) {
      refuse_missing(config, key, frame.open.base_directory / source,
                     source.ends_with('/') ? "folder" : "file", entry);
    }
  };
  if (!scenes::is_scene_list(frame.scene)) {
    refuse(frame.scene, "");
    return;
  }
  const auto entries = sim::with_places(config, [&] {
    return sim::KeyError::reported_under(key, [&] { return scenes::read_scene_list(frame.scene); });
  });
  for (const scenes::ListedScene& entry : entries) {
    refuse(entry.source, entry.name + ": ");
  }
}

std::optional<glm::dvec3> three(const sim::Config& config, std::string_view key,
                                const char* what = "coordinates, [x, y, z]") {
  const std::vector<double> numbers = config.reals(key);
  if (!numbers.empty() && numbers.size() != 3) {
    config.fail(key, std::string("must be three ") + what + ", not " + std::to_string(numbers.size()));
  }
  return numbers.empty() ? std::nullopt : std::optional(glm::dvec3(numbers[0], numbers[1], numbers[2]));
}

scenes::SkyOptions read_sky(sim::Config& config) {
  constexpr const char* colors = "numbers, [red, green, blue]";
  scenes::SkyOptions sky;
  sky.sky = three(config, "scene.sky", colors);
  sky.sun = three(config, "scene.sun");
  if (sky.sun == glm::dvec3(0.0)) {
    config.fail("scene.sun", "must be a direction, not [0, 0, 0]");
  }
  if (sky.sun) {
    sky.sun_color = three(config, "scene.sun_color", colors).value_or(sky.sun_color);
  }
  config.mark_unused_reason("scene.sun_color", "there is no sun", "scene.sun");
  return sky;
}

/// With the image's sizes in `render`: makes the frame a window of it.
void read_region(const sim::Config& config, processors::program::RenderOptions& render) {
  constexpr const char* key = "image.region";
  const std::vector<std::int64_t> region = config.integers(key);
  if (region.empty()) {
    return;
  }
  if (region.size() != 4) {
    config.fail(key, "must be [left, top, width, height], not " + std::to_string(region.size()) + " numbers");
  }
  if (region[2] == 0 || region[3] == 0) {
    config.fail(key, "has no pixels; its third number is its width, its fourth its height");
  }
  if (region[0] + region[2] > render.width || region[1] + region[3] > render.height) {
    config.fail(key,
                fmt::format("reaches to column {} and row {} of an image of {} x {} pixels (image.width, "
                            "image.height)",
                            region[0] + region[2], region[1] + region[3], render.width, render.height));
  }
  const auto pixels = [&](std::size_t i) { return static_cast<std::uint32_t>(region[i]); };
  render.window = {render.width, render.height, pixels(0), pixels(1)};
  render.width = pixels(2);
  render.height = pixels(3);
}

scenes::ViewOptions read_view(const sim::Config& config) {
  scenes::ViewOptions view{
      three(config, "scene.eye"), three(config, "scene.look_at"), three(config, "scene.up"), {}};
  if (const double degrees = config.real("scene.field_of_view"); degrees > 0.0) {
    constexpr double least = 1e-4;
    if (degrees < least) {
      config.fail("scene.field_of_view", "must be at least 0.0001 degrees, or 0 for the camera's");
    }
    view.vertical_fov = degrees * std::numbers::pi / 180.0;
  }
  return view;
}

void read_any_hit_rays(sim::Config& config, FrameConfig& frame) {
  const bool occlusion = frame.render.integrator == processors::program::Integrator::occlusion;
  frame.render.secondary_rays = count(config, "image.secondary_rays");
  frame.render.seed = static_cast<std::uint64_t>(config.integer("image.seed"));
  if (occlusion) {
    frame.render.occlusion_distance = config.real("image.occlusion_distance");
    frame.open.file.default_light = scenes::DefaultLight::never;
  }
  // No chains of rays: what planning and memory assume of deep ones need not be.
  frame.render.max_depth = 1;
  config.mark_unused_reason(
      "image", "with \"shadow\" and \"occlusion\" only image.secondary_rays rays follow what the eye sees",
      "image.integrator");
  config.mark_unused_reason("image.occlusion_distance", "shadow rays reach to their lights",
                            "image.integrator");
}

void read_gaussians(sim::Config& config, FrameConfig& frame) {
  frame.render.nearest_hits = count(config, "image.nearest_hits");
  if (frame.render.samples > 1) {
    frame.render.seed = static_cast<std::uint64_t>(config.integer("image.seed"));
  }
  frame.render.shadows = false;
  frame.open.file.default_light = scenes::DefaultLight::never;
  config.mark_unused_reason("image", "Gaussians are seen through, one behind the other, and not lit",
                            "image.integrator");
}

/// Where the camera is and what it sees, of which given rays know nothing.
void read_image(sim::Config& config, FrameConfig& frame) {
  frame.open.file.camera = config.text("scene.camera");
  frame.open.file.view = read_view(config);
  frame.open.file.sky = read_sky(config);
  frame.open.file.default_light = config.choice_as<scenes::DefaultLight>("scene.default_light");
  frame.render.width = count(config, "image.width");
  frame.render.height = count(config, "image.height");
  read_region(config, frame.render);
  const processors::program::Integrator integrator = frame.render.integrator;
  const bool path = integrator == processors::program::Integrator::path;
  frame.open.file.emitters_light = processors::program::asks_emitters(integrator);
  frame.open.file.sky_lights = path;
  frame.render.samples = count(config, "image.samples");
  if (processors::program::sends_any_hit_rays(integrator)) {
    read_any_hit_rays(config, frame);
    return;
  }
  if (integrator == processors::program::Integrator::gaussians) {
    read_gaussians(config, frame);
    return;
  }
  config.mark_unused_reason("image.nearest_hits", "only \"gaussians\" looks for several hits of a ray",
                            "image.integrator");
  config.mark_unused_reason("image.secondary_rays", "such rays are those of \"shadow\" and \"occlusion\"",
                            "image.integrator");
  config.mark_unused_reason("image.occlusion_distance", "such rays are those of \"occlusion\"",
                            "image.integrator");
  frame.render.max_depth = count(config, "image.max_depth");
  frame.render.min_weight = path ? 0.0 : config.real("image.min_weight");
  config.mark_unused_reason("image.min_weight",
                            "a path ends by chance, because rays cut off would darken the image",
                            "image.integrator");
  if (frame.render.samples > 1 || path) {
    frame.render.seed = static_cast<std::uint64_t>(config.integer("image.seed"));
  }
  config.mark_unused_reason("image.seed", "one sample lies in the pixel's centre", "image.samples");
  frame.render.shadows = config.boolean("image.shadows");
  frame.render.voxel_cut = config.real("image.voxel_cut");
  if (frame.render.voxel_cut > 0.0) {
    if (config.choice_name("structure.kind") != "octree") {
      config.fail("image.voxel_cut", "only an octree can be cut, not structure.kind = \"" +
                                         config.choice_name("structure.kind") + "\"");
    }
    if (path) {
      config.fail("image.voxel_cut",
                  "averages what lights and mirrors show, and with image.integrator = \"path\" a path also "
                  "follows scattered light");
    }
    frame.exact_too = config.boolean("image.voxel_cut_reference");
  } else {
    config.mark_unused_reason("image.voxel_cut_reference", "it has no effect with image.voxel_cut = 0",
                              "image.voxel_cut");
  }
  config.mark_unused_reason("image.rays", "only image.integrator = \"rays\" traces rays of a file",
                            "image.integrator");
}

/// The rays of a file take the place of the image's. Frames are rectangles, so these are cut into rows of as
/// equal length as whole numbers allow, long enough for packets of neighbours and short enough for all of
/// this computer's cores to have some.
void read_rays(sim::Config& config, FrameConfig& frame) {
  constexpr const char* key = "image.rays";
  const std::string name = config.text(key);
  if (name.empty()) {
    config.fail("image.integrator", "\"rays\" traces the rays of a file; name it with image.rays");
  }
  if (frame.log != nullptr) {
    frame.render.width = frame.log->head.width;
    frame.render.height = frame.log->head.height;
  } else {
    frame.open.rays = directory_of(config, key) / name;
    refuse_missing(config, key, frame.open.rays, "file");
    const std::uint64_t rays = sim::with_places(config, [&] {
      return sim::KeyError::reported_under(key, [&] { return scenes::count_rays(frame.open.rays); });
    });
    constexpr std::uint64_t least_row = 1024;
    const auto side = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(rays)));
    const std::uint64_t row = std::max(least_row, std::bit_ceil(side));
    const std::uint64_t rows = (rays + row - 1) / row;
    frame.render.height = static_cast<std::uint32_t>(rows);
    frame.render.width = static_cast<std::uint32_t>((rays + rows - 1) / rows);
  }
  frame.render.max_depth = 1;
  frame.render.shadows = false;
  frame.open.file.default_light = scenes::DefaultLight::never;
  constexpr std::string_view reason =
      "the rays of image.rays begin and end where their file says, and nothing is shaded";
  for (const std::string_view unused :
       {"image", "scene.camera", "scene.eye", "scene.look_at", "scene.up", "scene.field_of_view", "scene.sky",
        "scene.sun", "scene.sun_color", "scene.default_light"}) {
    config.mark_unused_reason(unused, reason, "image.integrator");
  }
}

}  // namespace

FrameConfig read_frame(sim::Config& config, FrameUse use) {
  FrameConfig frame;
  frame.log = read_log(config, use);
  frame.scene = config.text("scene.source");
  frame.open.base_directory = directory_of(config, "scene.source");
  if (frame.log == nullptr) {
    refuse_missing_scenes(config, frame);
  }
  frame.open.file.scene = config.text("scene.scene");
  frame.open.file.animation = config.text("scene.animation");
  frame.open.file.strict = config.boolean("scene.strict");
  frame.frames.count = count(config, "frames.count");
  frame.frames.first = count(config, "frames.first");
  frame.frames.rate = config.real("frames.rate");
  frame.open.file.time = frame.frames.time(0);
  config.mark_unused_reason("frames.verify", "only `marti study frames` renders frames twice");
  frame.render.integrator = config.choice_as<processors::program::Integrator>("image.integrator");
  if (frame.render.integrator == processors::program::Integrator::rays) {
    if (use != FrameUse::timing) {
      config.fail("image.integrator", "the study is of images; rays of a file are for runs and sweeps");
    }
    read_rays(config, frame);
  } else if (use != FrameUse::timing && use != FrameUse::frames &&
             (processors::program::sends_any_hit_rays(frame.render.integrator) ||
              frame.render.integrator == processors::program::Integrator::gaussians)) {
    config.fail("image.integrator",
                "the study is of whole images; \"shadow\", \"occlusion\" and \"gaussians\" are for runs, "
                "sweeps, and the study of frames");
  } else {
    read_image(config, frame);
  }
  read_structure(config, frame);
  read_for_units(config, frame);
  if (frame.log != nullptr) {
    if (frame.exact_too) {
      config.fail("image.voxel_cut_reference", "the exact image is traced, and a log has no images");
    }
    check_recorded(config, *frame.log, frame.render);
  }
  frame.memory = read_memory(config);
  give_memory(frame.memory, frame.structure_options);
  frame.open.file.memory = frame.memory;
  frame.open.file.size_first = host::size_of_image;
  return frame;
}

FrameConfig read_one_frame(sim::Config& config, FrameUse use) {
  FrameConfig frame = read_frame(config, use);
  if (frame.frames.count > 1) {
    config.fail("frames.count", "the study renders one frame, that of frames.first");
  }
  return frame;
}

}  // namespace marti::studies::keys
