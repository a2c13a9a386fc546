// All structures, their walks, with mailboxes and without, against Embree: primary rays on one thread, the
// same triangles and the same rays; and what the hierarchies cost by the surface area heuristic.
//   bench_rays [--scene NAME] [--size PIXELS] [--objects N] [--level N] [--json FILE]
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/mailbox.h"
#include "accel/structure.h"
#include "bench/report.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/support/embree_bvh.h"

namespace {

using marti::accel::Hit;
using marti::accel::Ray;
using marti::accel::Structure;
using marti::accel::TriangleSet;

struct Options {
  std::string scene = "teapot:12";
  std::uint32_t size = 512;
  marti::accel::OctreeOptions octree{16, 8};
};

/// Processor time of this program, which other work on the computer affects least.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The best of several passes of each kind, in seconds of processor time, taken in turns so that other
/// work on the computer affects all kinds alike.
std::vector<double> best_seconds(const std::vector<std::function<void()>>& passes) {
  std::vector<double> best(passes.size(), std::numeric_limits<double>::infinity());
  double spent = 0.0;
  for (int round = 0; round < 5 || (spent < 15.0 && round < 60); ++round) {
    for (std::size_t k = 0; k < passes.size(); ++k) {
      const double begin = cpu_seconds();
      passes[k]();
      const double seconds = cpu_seconds() - begin;
      best[k] = std::min(best[k], seconds);
      spent += seconds;
    }
  }
  return best;
}

/// The triangles in Embree, its hits, and the rays, converted beforehand so that only Embree is measured.
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

/// Numbers of rays that hit the same primitive, another one at the same distance (a tie), or something else.
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
    if (k + 1 >= argc) {
      throw marti::sim::UserError(
          "usage: bench_rays [--scene NAME] [--size PIXELS] [--objects N] [--level N] [--json FILE]");
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
      throw marti::sim::UserError("unknown option " + std::string(key));
    }
  }
  return options;
}

/// One of marti's structures, with mailboxes or without.
struct Contestant {
  std::string name;
  std::unique_ptr<Structure> structure;
  bool mailboxes = false;
  double build_seconds = 0.0;
  std::vector<Hit> hits;
};

/// Traces all rays with the concrete structure, so that the walk is inlined. Without mailboxes it is the walk
/// that a render uses.
void trace(Contestant& contestant, const std::vector<Ray>& rays) {
  marti::accel::visit_structure(*contestant.structure, [&](const auto& concrete) {
    const auto all = [&](auto& visitor) {
      for (std::size_t k = 0; k < rays.size(); ++k) {
        contestant.hits[k] = concrete.closest(rays[k], visitor);
      }
    };
    if (contestant.mailboxes) {
      marti::accel::Mailboxed<marti::accel::NullVisitor> visitor;
      visitor.prepare(concrete.triangles().size());
      all(visitor);
    } else {
      marti::accel::NullVisitor visitor;
      all(visitor);
    }
  });
}

/// Brute force is measured only where it takes at most this many tests.
constexpr double most_tests = 1e8;

std::vector<Contestant> build_all(const std::shared_ptr<const TriangleSet>& triangles, const Options& options,
                                  std::size_t rays) {
  std::vector<Contestant> all;
  marti::accel::StructureOptions structure_options;
  structure_options.octree = options.octree;
  structure_options.bsp.max_objects = options.octree.max_objects;
  structure_options.bsp.max_level = options.octree.max_level;
  const auto add = [&](const std::string& name, const char* kind) {
    for (const bool mailboxes : {false, true}) {
      if (mailboxes && std::string_view(kind) == "none") {
        continue;
      }
      Contestant& contestant = all.emplace_back();
      contestant.name = name + (mailboxes ? ", mailboxes" : "");
      contestant.mailboxes = mailboxes;
      contestant.hits.resize(rays);
      const double begin = cpu_seconds();
      contestant.structure = marti::accel::make_structure(kind, triangles, structure_options);
      contestant.build_seconds = cpu_seconds() - begin;
    }
  };
  add("octree", "octree");
  add("bsp, recursive", "bsp");
  structure_options.bsp.walk = marti::accel::BspWalk::push_point;
  add("bsp, push-point", "bsp");
  add("grid, density", "grid");
  structure_options.grid_match = marti::accel::GridMatch::octree_nodes;
  add("grid, octree's nodes", "grid");
  structure_options.grid_match = marti::accel::GridMatch::octree_cells;
  add("grid, octree's cells", "grid");
  for (std::size_t node = 0; node < marti::accel::bvh_node_names.size(); ++node) {
    structure_options.bvh.node = static_cast<marti::accel::BvhNodeKind>(node);
    add("bvh, " + std::string(marti::accel::bvh_node_names[node]) + " children", "bvh");
  }
  if (static_cast<double>(triangles->size()) * static_cast<double>(rays) <= most_tests) {
    add("none", "none");
  }
  return all;
}

std::optional<marti::bench::Aim> aim_of(std::string_view name) {
  if (name == "octree") {
    return marti::bench::Aim{0.4};
  }
  return name == "bvh, 8 children" ? std::optional(marti::bench::Aim{0.6}) : std::nullopt;
}

/// The hierarchies' costs by the surface area heuristic, beside those of Embree's builder.
void compare_costs(marti::bench::Report& report, const std::vector<Contestant>& ours) {
  for (const Contestant& contestant : ours) {
    const auto* of =
        dynamic_cast<const marti::accel::StructureOf<marti::accel::Bvh>*>(contestant.structure.get());
    if (of == nullptr || contestant.mailboxes) {
      continue;
    }
    const marti::accel::Bvh& bvh = of->concrete();
    const double theirs = marti::tests::embree_sah_cost(
        bvh.triangles(), marti::accel::bvh_children(bvh.options().node), bvh.options().max_objects);
    std::printf("%-32s cost by the surface area heuristic %.3f, Embree rtcBuildBVH %.3f: %.3f\n",
                contestant.name.c_str(), bvh.sah_cost(), theirs, bvh.sah_cost() / theirs);
    report.add(marti::bench::against("cost: " + contestant.name, "visits and tests", bvh.sah_cost(),
                                     "Embree rtcBuildBVH", theirs, marti::bench::Aim{1.05, false}));
  }
}

void run(marti::bench::Report& report, const Options& options) {
  const marti::scenes::Scene scene = marti::scenes::make_procedural(options.scene);
  const auto triangles = std::make_shared<const TriangleSet>(scene);
  if (!scene.quadrics.empty()) {
    throw marti::sim::UserError(options.scene + " is not made of triangles alone");
  }
  const marti::scenes::ImagePlane plane = scene.camera.image_plane(options.size, options.size);
  std::vector<Ray> rays;
  for (std::uint32_t y = 0; y < options.size; ++y) {
    for (std::uint32_t x = 0; x < options.size; ++x) {
      rays.push_back({plane.origin, plane.corner + (x + 0.5) * plane.step_x + (y + 0.5) * plane.step_y});
    }
  }

  std::vector<Contestant> ours = build_all(triangles, options, rays.size());
  EmbreeRun fast(*triangles, rays, false);
  EmbreeRun robust(*triangles, rays, true);
  std::vector<std::function<void()>> passes;
  for (Contestant& contestant : ours) {
    passes.emplace_back([&contestant, &rays] { trace(contestant, rays); });
  }
  passes.emplace_back([&] { fast.trace(); });
  passes.emplace_back([&] { robust.trace(); });
  const std::vector<double> seconds = best_seconds(passes);
  for (const Contestant& contestant : ours) {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      marti::sim::ensure(contestant.hits[k].primitive == ours[0].hits[k].primitive,
                         "bench_rays: two structures disagree");
    }
  }
  const Agreement with_fast = compare(ours[0].hits, fast);
  const Agreement with_robust = compare(ours[0].hits, robust);
  const double million = static_cast<double>(rays.size()) * 1e-6;
  const auto found = static_cast<std::size_t>(
      std::count_if(ours[0].hits.begin(), ours[0].hits.end(), [](const Hit& h) { return h.found(); }));
  std::printf("%s: %u triangles, %zu primary rays, %zu hit; max_objects %u, max_level %u; one thread\n",
              options.scene.c_str(), triangles->size(), rays.size(), found, options.octree.max_objects,
              options.octree.max_level);
  std::printf("%-32s %10s %9s %10s %8s\n", "", "nodes", "CPU s", "M rays/s", "Embree=1");
  for (std::size_t k = 0; k < ours.size(); ++k) {
    std::printf("%-32s %10zu %9.3f %10.3f %8.3f\n", ours[k].name.c_str(),
                ours[k].structure->topology().nodes.size(), ours[k].build_seconds, million / seconds[k],
                seconds[ours.size()] / seconds[k]);
  }
  const auto embree = [&](const char* name, double time, const Agreement& agreement) {
    std::printf("%-32s %10s %9s %10.3f %8.3f   hits: %zu the same, %zu ties, %zu different\n", name, "", "",
                million / time, seconds[ours.size()] / time, agreement.same, agreement.tie, agreement.other);
  };
  embree("Embree rtcIntersect1", seconds[ours.size()], with_fast);
  embree("Embree, robust", seconds[ours.size() + 1], with_robust);

  using marti::bench::against;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const std::optional<marti::bench::Aim> aim = aim_of(ours[k].name);
    report.add(against("primary rays: " + ours[k].name, "M rays/s", million / seconds[k],
                       "Embree rtcIntersect1", million / seconds[ours.size()], aim));
  }
  report.add(against("primary rays: " + ours[0].name, "M rays/s", million / seconds[0], "Embree, robust",
                     million / seconds[ours.size() + 1]));
  compare_costs(report, ours);
}

}  // namespace

int main(int argc, char** argv) {
  return marti::bench::run_benchmark("bench_rays", argc, argv,
                                     [](marti::bench::Report& report, int count, char** values) {
                                       run(report, read_options(count, values));
                                     });
}
