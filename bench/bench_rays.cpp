// Octree against Embree: primary rays on one thread, the same triangles and the same rays.
//   bench_rays [--scene NAME] [--size PIXELS] [--objects N] [--level N] [--json]
#include <embree3/rtcore.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "accel/octree.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace {

using marti::accel::Hit;
using marti::accel::Octree;
using marti::accel::Ray;
using marti::accel::TriangleSet;

struct Options {
  std::string scene = "teapot:12";
  std::uint32_t size = 512;
  marti::accel::OctreeOptions octree{16, 8};
  bool json = false;
};

/// The best of several passes of each kind, in seconds, taken in turns so that whatever else the machine does
/// meets all kinds alike.
std::vector<double> best_seconds(const std::vector<std::function<void()>>& passes) {
  std::vector<double> best(passes.size(), std::numeric_limits<double>::infinity());
  double spent = 0.0;
  for (int round = 0; round < 5 || (spent < 5.0 && round < 60); ++round) {
    for (std::size_t k = 0; k < passes.size(); ++k) {
      const auto begin = std::chrono::steady_clock::now();
      passes[k]();
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      best[k] = std::min(best[k], seconds);
      spent += seconds;
    }
  }
  return best;
}

/// The triangles in Embree, the rays converted beforehand (the measurement is Embree's alone), its answers.
class EmbreeRun {
 public:
  EmbreeRun(const TriangleSet& triangles, const std::vector<Ray>& rays, bool robust)
      : primitives(rays.size()), t(rays.size()), queries_(rays.size()) {
    device_ = rtcNewDevice("threads=1");
    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    attach(triangles);
    rtcCommitScene(scene_);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      RTCRayHit& q = queries_[k];
      q.ray = {};
      q.ray.org_x = static_cast<float>(rays[k].origin.x);
      q.ray.org_y = static_cast<float>(rays[k].origin.y);
      q.ray.org_z = static_cast<float>(rays[k].origin.z);
      q.ray.dir_x = static_cast<float>(rays[k].direction.x);
      q.ray.dir_y = static_cast<float>(rays[k].direction.y);
      q.ray.dir_z = static_cast<float>(rays[k].direction.z);
      q.ray.tfar = std::numeric_limits<float>::infinity();
      q.ray.mask = 0xffffffffU;
      q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      q.hit.primID = RTC_INVALID_GEOMETRY_ID;
      q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    }
  }
  EmbreeRun(const EmbreeRun&) = delete;
  EmbreeRun& operator=(const EmbreeRun&) = delete;
  ~EmbreeRun() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  /// Traces all rays once.
  void trace() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::size_t k = 0; k < queries_.size(); ++k) {
      RTCRayHit query = queries_[k];
      rtcIntersect1(scene_, &context, &query);
      primitives[k] = query.hit.primID;
      t[k] = query.ray.tfar;
    }
  }

  std::vector<std::uint32_t> primitives;
  std::vector<float> t;

 private:
  void attach(const TriangleSet& triangles) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t n = triangles.size();
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * n));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), n));
    for (std::uint32_t id = 0; id < n; ++id) {
      for (std::size_t c = 0; c < 9; ++c) {
        vertices[std::size_t{9} * id + c] = static_cast<float>(triangles[id][c]);
      }
      for (std::uint32_t c = 0; c < 3; ++c) {
        indices[std::size_t{3} * id + c] = 3 * id + c;
      }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<RTCRayHit> queries_;
};

/// Of all rays: seen the same primitive, another one at the same distance (a tie), or something else.
struct Agreement {
  std::size_t same = 0;
  std::size_t tie = 0;
  std::size_t other = 0;
};

Agreement compare(const std::vector<Hit>& ours, const EmbreeRun& theirs) {
  Agreement agreement;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    if (ours[k].primitive == theirs.primitives[k]) {
      ++agreement.same;
    } else if (ours[k].found() && std::abs(ours[k].t - theirs.t[k]) <= 1e-5 * ours[k].t) {
      ++agreement.tie;
    } else {
      ++agreement.other;
    }
  }
  return agreement;
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string_view key = argv[k];
    if (key == "--json") {
      options.json = true;
      continue;
    }
    if (k + 1 >= argc) {
      throw marti::sim::UserError(
          "usage: bench_rays [--scene NAME] [--size PIXELS] [--objects N] [--level N] [--json]");
    }
    const char* value = argv[++k];
    const auto number = [value] { return static_cast<std::uint32_t>(std::strtoul(value, nullptr, 10)); };
    if (key == "--scene") {
      options.scene = value;
    } else if (key == "--size") {
      options.size = number();
    } else if (key == "--objects") {
      options.octree.max_objects = number();
    } else if (key == "--level") {
      options.octree.max_level = number();
    } else {
      throw marti::sim::UserError("bench_rays: unknown option " + std::string(key));
    }
  }
  return options;
}

void run(const Options& options) {
  const marti::scenes::Scene scene = marti::scenes::make_procedural(options.scene);
  const auto triangles = std::make_shared<const TriangleSet>(scene);
  if (!scene.quadrics.empty()) {
    throw marti::sim::UserError("bench_rays: " + options.scene + " is not made of triangles alone");
  }
  const auto build_begin = std::chrono::steady_clock::now();
  const Octree octree = Octree::build(triangles, options.octree);
  const double build_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - build_begin).count();

  const marti::scenes::ImagePlane plane = scene.camera.image_plane(options.size, options.size);
  std::vector<Ray> rays;
  for (std::uint32_t y = 0; y < options.size; ++y) {
    for (std::uint32_t x = 0; x < options.size; ++x) {
      rays.push_back({plane.origin, plane.corner + (x + 0.5) * plane.step_x + (y + 0.5) * plane.step_y});
    }
  }

  std::vector<Hit> hits(rays.size());
  marti::accel::NullVisitor visitor;
  EmbreeRun fast(*triangles, rays, false);
  EmbreeRun robust(*triangles, rays, true);
  const std::vector<double> seconds = best_seconds({[&] {
                                                      for (std::size_t k = 0; k < rays.size(); ++k) {
                                                        hits[k] = octree.closest(rays[k], visitor);
                                                      }
                                                    },
                                                    [&] { fast.trace(); }, [&] { robust.trace(); }});
  const auto found = static_cast<std::size_t>(
      std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.found(); }));
  const Agreement with_fast = compare(hits, fast);
  const Agreement with_robust = compare(hits, robust);
  const double million = static_cast<double>(rays.size()) * 1e-6;

  if (options.json) {
    std::printf(
        "{\"scene\": \"%s\", \"triangles\": %u, \"rays\": %zu, \"hits\": %zu, \"max_objects\": %u, "
        "\"max_level\": %u, "
        "\"build_seconds\": %.6g, \"octree_mrays_per_second\": %.6g, \"embree_mrays_per_second\": %.6g, "
        "\"embree_robust_mrays_per_second\": %.6g, \"ratio\": %.6g, \"ratio_robust\": %.6g, "
        "\"same\": %zu, \"ties\": %zu, \"different\": %zu, "
        "\"robust_same\": %zu, \"robust_ties\": %zu, \"robust_different\": %zu}\n",
        options.scene.c_str(), triangles->size(), rays.size(), found, options.octree.max_objects,
        options.octree.max_level, build_seconds, million / seconds[0], million / seconds[1],
        million / seconds[2], seconds[1] / seconds[0], seconds[2] / seconds[0], with_fast.same, with_fast.tie,
        with_fast.other, with_robust.same, with_robust.tie, with_robust.other);
    return;
  }
  std::printf(
      "%s: %u triangles, %zu primary rays, %zu hit; octree of %zu nodes (max_objects %u, max_level %u), "
      "built in %.3f s\n",
      options.scene.c_str(), triangles->size(), rays.size(), found, octree.topology().nodes.size(),
      options.octree.max_objects, options.octree.max_level, build_seconds);
  std::printf("%-24s %10s %8s   %s\n", "one thread", "M rays/s", "ratio", "hits: same / ties / different");
  std::printf("%-24s %10.2f\n", "octree, double", million / seconds[0]);
  std::printf("%-24s %10.2f %8.3f   %zu / %zu / %zu\n", "Embree rtcIntersect1", million / seconds[1],
              seconds[1] / seconds[0], with_fast.same, with_fast.tie, with_fast.other);
  std::printf("%-24s %10.2f %8.3f   %zu / %zu / %zu\n", "Embree, robust", million / seconds[2],
              seconds[2] / seconds[0], with_robust.same, with_robust.tie, with_robust.other);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(read_options(argc, argv));
    return 0;
  } catch (const marti::sim::UserError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "internal error: %s\n", error.what());
    return 1;
  }
}
