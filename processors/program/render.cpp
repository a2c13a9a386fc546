#include "processors/program/render.h"

#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "processors/program/render_rows.h"
#include "processors/program/voxel_average.h"
#include "sim/key_error.h"

namespace marti::processors::program {

namespace {

void check_options(const RenderOptions& options) {
  const auto in_range = [](const char* name, std::uint32_t value, std::uint32_t low, std::uint32_t high) {
    if (value < low || value > high) {
      throw sim::UserError(std::string("the render's ") + name + " is " + std::to_string(value) +
                           "; it must be from " + std::to_string(low) + " to " + std::to_string(high));
    }
  };
  in_range("width", options.width, 1, max_image_side);
  in_range("height", options.height, 1, max_image_side);
  if (const std::optional<Window>& window = options.window) {
    in_range("image_width", window->image_width, 1, max_image_side);
    in_range("image_height", window->image_height, 1, max_image_side);
    sim::ensure(window->left <= window->image_width && window->top <= window->image_height &&
                    options.width <= window->image_width - window->left &&
                    options.height <= window->image_height - window->top,
                "render: the window reaches out of its image");
  }
  in_range("max_depth", options.max_depth, 1, max_ray_depth);
  in_range("samples", options.samples, 1, max_samples);
  in_range("secondary_rays", options.secondary_rays, 1, max_secondary_rays);
  in_range("nearest_hits", options.nearest_hits, 1, max_nearest_hits);
  if (!(options.occlusion_distance >= 0.0 && std::isfinite(options.occlusion_distance))) {
    throw sim::UserError("the render's occlusion_distance is " + std::to_string(options.occlusion_distance) +
                         "; it must be finite and not below 0");
  }
  if (!(options.min_weight >= 0.0 && options.min_weight <= 1.0)) {
    throw sim::UserError("the render's min_weight is " + std::to_string(options.min_weight) +
                         "; it must be from 0 to 1");
  }
  if (!(options.voxel_cut >= 0.0 && std::isfinite(options.voxel_cut))) {
    throw sim::UserError("the render's voxel_cut is " + std::to_string(options.voxel_cut) +
                         "; it must be finite and not below 0");
  }
  sim::ensure(options.only == nullptr ||
                  (options.only->width() == options.width && options.only->height() == options.height),
              "render: the set of pixels is of another image");
  const Frame* const before = options.before;
  sim::ensure(before == nullptr ||
                  (options.only != nullptr && before->image.width == options.width &&
                   before->image.height == options.height && (before->log != nullptr) == options.record),
              "render: the frame that is continued is another one");
  if (options.integrator == Integrator::path && options.voxel_cut > 0.0) {
    throw sim::KeyError("image.voxel_cut",
                        "averages what mirrors and lights show, and a path also follows scattered light; set "
                        "image.voxel_cut = 0");
  }
  if (options.integrator == Integrator::path && options.min_weight > 0.0) {
    throw sim::KeyError("image.min_weight",
                        "cutting rays off would darken a path-traced image, which ends paths by chance "
                        "instead; set image.min_weight = 0");
  }
  if ((sends_any_hit_rays(options.integrator) || options.integrator == Integrator::gaussians) &&
      options.voxel_cut > 0.0) {
    throw sim::KeyError("image.voxel_cut",
                        "averages what mirrors and lights show; set image.voxel_cut = 0 where no more than "
                        "shadows or Gaussians are asked for");
  }
  if (options.integrator == Integrator::gaussians && options.floats) {
    throw sim::UserError("Gaussians are met in doubles; they cannot be rendered in floats");
  }
  if (options.integrator == Integrator::rays) {
    sim::ensure(options.voxel_cut == 0.0 && options.samples == 1 && !options.window &&
                    (!options.hits || options.before == nullptr),
                "render: given rays are traced once, whole, and exactly");
  }
  if (options.floats && options.voxel_cut > 0.0) {
    throw sim::UserError("the voxel cut averages in doubles; it cannot be rendered in floats");
  }
}

/// The voxels of the frame; std::nullopt when no cell can be small, because then the exact walk suffices.
std::optional<VoxelAverages> make_voxels(const scenes::Scene& scene, const accel::Octree& octree,
                                         const RenderOptions& options, unsigned threads) {
  const unsigned level = first_small_level(octree.bounds(), image_plane(scene.camera, options),
                                           options.voxel_cut, options.max_depth);
  if (level > octree.levels().size()) {
    return std::nullopt;
  }
  return VoxelAverages::build(scene, octree, level, threads);
}

std::uint32_t material_records(const scenes::Scene& scene, const RenderOptions& options) {
  return static_cast<std::uint32_t>(options.integrator == Integrator::gaussians
                                        ? scene.gaussians->shapes.size() * scene.gaussians->records()
                                        : scene.materials.size());
}

/// The log without its rows: what it says of the database.
WorkLog start_log(const scenes::Scene& scene, const accel::Structure& structure, const Emitters& emitters,
                  const RenderOptions& options) {
  WorkLog log;
  log.traversal = accel::traversal_of(structure);
  log.integrator = options.integrator;
  log.mailboxes = options.mailboxes;
  log.order = options.order;
  log.treelet_records = options.treelet_records;
  log.width = options.width;
  log.height = options.height;
  log.samples = options.samples;
  log.topology = structure.topology();
  const accel::TriangleSet& primitives = structure.triangles();
  log.primitives = primitives.size();
  for (std::uint32_t id = primitives.triangles(); id < primitives.size(); ++id) {
    log.quadrics.push_back(primitives.kind(id));
  }
  log.materials = material_records(scene, options);
  log.lights = options.integrator == Integrator::occlusion
                   ? 1
                   : static_cast<std::uint32_t>(scene.lights.size()) + (emitters.empty() ? 0U : 1U);
  log.texture_begin.push_back(0);
  for (const scenes::Texture& texture : scene.textures) {
    log.texture_begin.push_back(log.texture_begin.back() + texture.size());
  }
  log.rows.resize(options.height);
  return log;
}

}  // namespace

scenes::ImagePlane image_plane(const scenes::Camera& camera, const RenderOptions& options) {
  return options.window ? camera.image_plane(options.window->image_width, options.window->image_height)
                        : camera.image_plane(options.width, options.height);
}

RayCounts& RayCounts::operator+=(const RayCounts& other) {
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    traced[kind] += other.traced[kind];
    hit[kind] += other.hit[kind];
    voxels[kind] += other.voxels[kind];
  }
  return *this;
}

Frame render(const scenes::Scene& scene, const accel::TriangleSet& triangles,
             const accel::Structure& structure, const RenderOptions& options, unsigned threads) {
  check_options(options);
  sim::ensure(triangles.triangles() == scene.triangles.size() &&
                  triangles.size() == scene.triangles.size() + scene.quadrics.size() &&
                  structure.triangles().size() == triangles.size(),
              "render: the structure was built over other primitives than the scene's");
  if (options.integrator == Integrator::rays && scene.rays.rays.empty()) {
    throw sim::KeyError("image.integrator",
                        "\"rays\" needs the rays of a file (image.rays), which this command does not trace");
  }
  if (options.integrator == Integrator::gaussians) {
    if (scene.gaussians == nullptr) {
      throw sim::KeyError("image.integrator",
                          "\"gaussians\" needs a scene of Gaussians: a PLY file of 3D Gaussian splatting, or "
                          "gaussians:12");
    }
    if (options.meets) {
      throw sim::KeyError("rt.share",
                          "which Gaussians are the nearest would rest on who helps whom; set rt.share = "
                          "\"none\"");
    }
  }
  if (options.meets && triangles.cut_outs() != nullptr) {
    throw sim::KeyError(
        "rt.share",
        "which hits of triangles with holes are asked about would rest on who helps whom, and "
        "scene.source has such triangles; set rt.share = \"none\"");
  }
  if (options.meets && !triangles.instances().empty()) {
    throw sim::KeyError("rt.share",
                        "what a ray meets in kept instances is not recorded; set structure.instances = "
                        "\"copied\" or rt.share = \"none\"");
  }
  Frame frame;
  frame.image.width = options.width;
  frame.image.height = options.height;
  frame.image.pixels.resize(std::size_t{options.width} * options.height);
  frame.hits.resize(options.hits ? frame.image.pixels.size() : 0);

  std::optional<VoxelAverages> voxels;
  if (options.voxel_cut > 0.0) {
    const auto* octree = dynamic_cast<const accel::StructureOf<accel::Octree>*>(&structure);
    if (octree == nullptr) {
      throw sim::KeyError("image.voxel_cut",
                          "the voxel cut needs an octree, not \"" + std::string(structure.kind()) + "\"");
    }
    // An error at any threshold, so that a small one does not seem to work.
    if (!scene.quadrics.empty()) {
      throw sim::KeyError("image.voxel_cut", "averages triangles only, and scene.source has " +
                                                 std::to_string(scene.quadrics.size()) +
                                                 " spheres, cylinders and cones; set image.voxel_cut = 0");
    }
    if (triangles.cut_outs() != nullptr) {
      throw sim::KeyError("image.voxel_cut",
                          "averages whole triangles, and scene.source has some with holes; set "
                          "image.voxel_cut = 0");
    }
    voxels = make_voxels(scene, octree->concrete(), options, threads);
  }
  frame.voxels = voxels ? voxels->size() : 0;
  frame.first_voxel_level = voxels ? voxels->first_level() : 0;

  const Emitters emitters = asks_emitters(options.integrator) ? Emitters(scene) : Emitters();
  WorkLog log;
  if (options.record) {
    check_log_capacity(structure.topology().nodes.size(), material_records(scene, options) + frame.voxels,
                       scene.lights.size() + 1, scene.textures.size());
    log = start_log(scene, structure, emitters, options);
    log.voxels = frame.voxels;
    log.materials += log.voxels;
  }
  const auto in_doubles = [&](const auto& concrete) {
    render_with<double>(scene, concrete, emitters, options, threads, log.rows, frame);
  };
  if (options.order != accel::WalkOrder::depth_first) {
    render_in_order(scene, structure, emitters, options, threads, log.rows, frame);
  } else if (options.floats) {
    render_in_floats(scene, structure, emitters, options, threads, log.rows, frame);
  } else {
    accel::visit_structure(structure, [&](const auto& concrete) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(concrete)>, accel::Octree>) {
        if (voxels) {
          in_doubles(CutStructure(concrete, *voxels, options.voxel_cut));
          return;
        }
      }
      in_doubles(concrete);
    });
  }
  if (options.record) {
    frame.log = std::make_shared<const WorkLog>(std::move(log));
  }
  return frame;
}

}  // namespace marti::processors::program
