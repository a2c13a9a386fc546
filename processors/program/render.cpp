#include "processors/program/render.h"

#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "accel/mailbox.h"
#include "accel/structure.h"
#include "processors/program/recorder.h"
#include "processors/program/tracer.h"
#include "processors/program/voxel_average.h"
#include "sim/error.h"

namespace marti::processors {

namespace {

constexpr std::uint32_t max_size = 32768;

void check_options(const RenderOptions& options) {
  const auto in_range = [](const char* name, std::uint32_t value, std::uint32_t low, std::uint32_t high) {
    if (value < low || value > high) {
      throw sim::UserError(std::string("the render's ") + name + " is " + std::to_string(value) +
                           "; it must be from " + std::to_string(low) + " to " + std::to_string(high));
    }
  };
  in_range("width", options.width, 1, max_size);
  in_range("height", options.height, 1, max_size);
  in_range("max_depth", options.max_depth, 1, max_ray_depth);
  if (!(options.min_weight >= 0.0 && options.min_weight <= 1.0)) {
    throw sim::UserError("the render's min_weight is " + std::to_string(options.min_weight) +
                         "; it must be from 0 to 1");
  }
  if (!(options.voxel_cut >= 0.0 && std::isfinite(options.voxel_cut))) {
    throw sim::UserError("the render's voxel_cut is " + std::to_string(options.voxel_cut) +
                         "; it must be finite and not below 0");
  }
}

/// The voxels of the frame; none when no cell can be small, and then the exact walk does it.
std::optional<VoxelAverages> make_voxels(const scenes::Scene& scene, const accel::Octree& octree,
                                         const RenderOptions& options, unsigned threads) {
  const unsigned level =
      first_small_level(octree.bounds(), scene.camera.image_plane(options.width, options.height),
                        options.voxel_cut, options.max_depth);
  if (level > octree.levels().size()) {
    return std::nullopt;
  }
  return VoxelAverages::build(scene, octree, level, threads);
}

/// The log's database side: everything but the rows.
WorkLog start_log(const scenes::Scene& scene, const accel::Structure& structure,
                  const RenderOptions& options) {
  WorkLog log;
  log.traversal = accel::traversal_of(structure);
  log.mailboxes = options.mailboxes;
  log.width = options.width;
  log.height = options.height;
  log.topology = structure.topology();
  const accel::TriangleSet& primitives = structure.triangles();
  log.primitives = primitives.size();
  for (std::uint32_t id = primitives.triangles(); id < primitives.size(); ++id) {
    log.quadrics.push_back(primitives.kind(id));
  }
  log.materials = static_cast<std::uint32_t>(scene.materials.size());
  log.lights = static_cast<std::uint32_t>(scene.lights.size());
  log.texture_begin.push_back(0);
  for (const scenes::Texture& texture : scene.textures) {
    log.texture_begin.push_back(log.texture_begin.back() + texture.size());
  }
  log.rows.resize(options.height);
  return log;
}

/// What one host thread keeps from row to row.
template <typename Recorder>
struct Worker {
  Recorder recorder;
  RayCounts rays;
  std::uint64_t hit_hash = 0;
};

/// Renders all rows; `rows` is where a RowRecorder's rows go, with mailboxes or without.
template <typename Structure, typename Recorder>
void render_rows(const scenes::Scene& scene, const Structure& structure, const RenderOptions& options,
                 unsigned threads, std::vector<LogRow>& rows, Frame& frame) {
  const scenes::ImagePlane plane = scene.camera.image_plane(options.width, options.height);
  tbb::enumerable_thread_specific<Worker<Recorder>> workers;

  const auto render_row = [&](std::uint32_t y) {
    Worker<Recorder>& worker = workers.local();
    Tracer<double, Structure, Recorder> tracer(scene, structure, plane, options, worker.recorder);
    constexpr bool recording = std::is_base_of_v<RowRecorder, Recorder>;
    if constexpr (accel::has_mailboxes<Recorder>) {
      worker.recorder.prepare(structure.triangles().size());
    }
    if constexpr (recording) {
      worker.recorder.begin_row(options.width);
    }
    glm::vec3* pixels = frame.image.pixels.data() + std::size_t{y} * options.width;
    for (std::uint32_t x = 0; x < options.width; ++x) {
      const Vec3<double> color = tracer.trace(x, y);
      pixels[x] = {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z)};
    }
    if constexpr (recording) {
      worker.recorder.end_row(rows[y]);
    }
    worker.rays += tracer.rays();
    worker.hit_hash += tracer.hit_hash();
  };

  // More threads than cores are asked for by tests of determinism; TBB grants them only on request.
  std::optional<tbb::global_control> more_threads;
  if (threads > static_cast<unsigned>(tbb::info::default_concurrency())) {
    more_threads.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute([&] {
    // Rows differ in cost by orders of magnitude: the smallest grain, handed out as threads fall idle.
    tbb::parallel_for(
        tbb::blocked_range<std::uint32_t>(0, options.height, 1),
        [&](const tbb::blocked_range<std::uint32_t>& range) {
          for (std::uint32_t y = range.begin(); y < range.end(); ++y) {
            render_row(y);
          }
        },
        tbb::simple_partitioner());
  });
  // Integer sums: the order of the threads does not matter.
  for (const Worker<Recorder>& worker : workers) {
    frame.rays += worker.rays;
    frame.hit_hash += worker.hit_hash;
  }
}

}  // namespace

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
  Frame frame;
  frame.image.width = options.width;
  frame.image.height = options.height;
  frame.image.pixels.resize(std::size_t{options.width} * options.height);

  std::optional<VoxelAverages> voxels;
  if (options.voxel_cut > 0.0) {
    const auto* octree = dynamic_cast<const accel::StructureOf<accel::Octree>*>(&structure);
    if (octree == nullptr) {
      throw sim::UserError("the voxel cut needs an octree, not \"" + std::string(structure.kind()) + "\"");
    }
    // Whatever the threshold, so that a smaller one does not seem to work.
    if (!scene.quadrics.empty()) {
      throw sim::UserError("image.voxel_cut averages triangles only, and scene.source has " +
                           std::to_string(scene.quadrics.size()) +
                           " spheres, cylinders and cones; set image.voxel_cut = 0");
    }
    voxels = make_voxels(scene, octree->concrete(), options, threads);
  }
  frame.voxels = voxels ? voxels->size() : 0;
  frame.first_voxel_level = voxels ? voxels->first_level() : 0;

  WorkLog log;
  if (options.record) {
    check_log_capacity(structure.topology().nodes.size(), scene.materials.size() + frame.voxels,
                       scene.lights.size(), scene.textures.size());
    log = start_log(scene, structure, options);
    log.voxels = frame.voxels;
    log.materials += log.voxels;
  }
  const auto render_with = [&](const auto& concrete) {
    using Concrete = std::remove_cvref_t<decltype(concrete)>;
    const auto run = [&]<typename Recorder>(Recorder /*which*/) {
      render_rows<Concrete, Recorder>(scene, concrete, options, threads, log.rows, frame);
    };
    const bool mailboxes = options.mailboxes && options.keep_mailboxes;
    if (mailboxes && options.record) {
      run(accel::Mailboxed<RowRecorder>());
    } else if (mailboxes) {
      run(accel::Mailboxed<NullRecorder>());
    } else if (options.record) {
      run(RowRecorder());
    } else {
      run(NullRecorder());
    }
  };
  accel::visit_structure(structure, [&](const auto& concrete) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(concrete)>, accel::Octree>) {
      if (voxels) {
        render_with(CutStructure(concrete, *voxels, options.voxel_cut));
        return;
      }
    }
    render_with(concrete);
  });
  if (options.record) {
    frame.log = std::make_shared<const WorkLog>(std::move(log));
  }
  return frame;
}

}  // namespace marti::processors
