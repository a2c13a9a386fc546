// Renders the rows of a frame on all host cores, with one kind of tracer; render.cpp and render_floats.cpp
// instantiate it.
#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "accel/bvh.h"
#include "accel/mailbox.h"
#include "accel/structure.h"
#include "processors/program/recorder.h"
#include "processors/program/render.h"
#include "processors/program/tracer.h"

namespace marti::processors::program {

/// What one host thread keeps from row to row.
template <typename Recorder>
struct Worker {
  Recorder recorder;
  std::unique_ptr<RayMeets> meets;  // where the rows have what rays meet
  RayCounts rays;
  std::uint64_t hit_hash = 0;
};

/// What rays meet in a bounding volume hierarchy whose hits are computed in floats or in doubles.
[[nodiscard]] std::unique_ptr<RayMeets> make_ray_meets(const accel::Bvh& bvh, bool floats);

/// Renders all rows. A RowRecorder, with mailboxes or without, writes its rows to `rows`.
template <typename Real, typename Structure, typename Recorder>
void render_rows(const scenes::Scene& scene, const Structure& structure, const Emitters& emitters,
                 const RenderOptions& options, unsigned threads, std::vector<LogRow>& rows, Frame& frame) {
  const scenes::ImagePlane plane = image_plane(scene.camera, options);
  const RayGrid grid(structure.triangles().bounds());
  tbb::enumerable_thread_specific<Worker<Recorder>> workers;

  const auto render_row = [&](std::uint32_t y) {
    Worker<Recorder>& worker = workers.local();
    Tracer<Real, Structure, Recorder> tracer(scene, structure, emitters, plane, options, worker.recorder);
    constexpr bool recording = std::is_base_of_v<RowRecorder, Recorder>;
    if constexpr (accel::has_mailboxes<Recorder>) {
      worker.recorder.prepare(structure.triangles().size());
    }
    if constexpr (recording) {
      if constexpr (requires { structure.bvh(); }) {
        if (options.meets && worker.meets == nullptr) {
          worker.meets = make_ray_meets(structure.bvh(), options.floats);
        }
      }
      worker.recorder.begin_row(options.width, options.ray_words ? &grid : nullptr, worker.meets.get());
    }
    glm::vec3* pixels = frame.image.pixels.data() + std::size_t{y} * options.width;
    for (std::uint32_t x = 0; x < options.width; ++x) {
      if (options.only != nullptr && !options.only->has(x, y)) {
        worker.recorder.begin_pixel();
        if (options.before != nullptr) {
          pixels[x] = options.before->image.at(x, y);
          if constexpr (recording) {
            worker.recorder.copy(options.before->log->rows[y], x);
          }
        }
        continue;
      }
      const Vec3<Real> color = tracer.trace(x, y);
      pixels[x] = {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z)};
      if (options.hits) {
        frame.hits[std::size_t{y} * options.width + x] = tracer.given_hit();
      }
    }
    if constexpr (recording) {
      worker.recorder.end_row(rows[y]);
    }
    worker.rays += tracer.rays();
    worker.hit_hash += tracer.hit_hash();
    count_step(options.meter);
  };

  // Tests of determinism ask for more threads than cores; TBB grants them only through this control.
  std::optional<tbb::global_control> more_threads;
  if (threads > static_cast<unsigned>(tbb::info::default_concurrency())) {
    more_threads.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute([&] {
    // Rows differ in cost by orders of magnitude, so threads take one row at a time as they fall idle.
    tbb::parallel_for(
        tbb::blocked_range<std::uint32_t>(0, options.height, 1),
        [&](const tbb::blocked_range<std::uint32_t>& range) {
          for (std::uint32_t y = range.begin(); y < range.end(); ++y) {
            render_row(y);
          }
        },
        tbb::simple_partitioner());
  });
  // The sums are of integers, so the order of the threads does not matter.
  for (const Worker<Recorder>& worker : workers) {
    frame.rays += worker.rays;
    frame.hit_hash += worker.hit_hash;
  }
  if (options.before != nullptr) {
    frame.rays += options.before->rays;
    frame.hit_hash += options.before->hit_hash;
  }
}

/// All rows, with the recorder that the options ask for.
template <typename Real, typename Structure>
void render_with(const scenes::Scene& scene, const Structure& structure, const Emitters& emitters,
                 const RenderOptions& options, unsigned threads, std::vector<LogRow>& rows, Frame& frame) {
  const auto run = [&]<typename Recorder>(Recorder /*which*/) {
    render_rows<Real, Structure, Recorder>(scene, structure, emitters, options, threads, rows, frame);
  };
  const bool mailboxes = options.mailboxes && options.keep_mailboxes;
  if (mailboxes && options.record) {
    run(accel::Mailboxed<RowRecorder>());
  } else if (mailboxes) {
    run(accel::Mailboxed<NullRecorder>());
  } else if (options.record) {
    if constexpr (std::is_same_v<Structure, accel::Bvh> || std::is_same_v<Structure, accel::TwoLevelBvh>) {
      if (options.entered) {
        run(EnteredRecorder());
        return;
      }
    }
    run(RowRecorder());
  } else {
    run(NullRecorder());
  }
}

/// render_with() for RenderOptions::order other than depth first.
void render_in_order(const scenes::Scene& scene, const accel::Structure& structure, const Emitters& emitters,
                     const RenderOptions& options, unsigned threads, std::vector<LogRow>& rows, Frame& frame);

/// render_with() for any structure, in floats.
void render_in_floats(const scenes::Scene& scene, const accel::Structure& structure, const Emitters& emitters,
                      const RenderOptions& options, unsigned threads, std::vector<LogRow>& rows,
                      Frame& frame);

}  // namespace marti::processors::program
