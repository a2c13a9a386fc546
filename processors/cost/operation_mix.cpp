#include "processors/cost/operation_mix.h"

#include <optional>

#include "accel/intersect.h"
#include "accel/mailbox.h"
#include "accel/structure.h"
#include "accel/watertight.h"
#include "processors/program/recorder.h"
#include "processors/program/tracer.h"
#include "sim/error.h"

namespace marti::processors::cost {

namespace {

using accel::Counted;
using accel::OperationCounts;

struct Buckets {
  std::array<OperationCounts, program::ray_kinds> ray{};
  OperationCounts branch;
  OperationCounts transform;
  OperationCounts leaf;
  OperationCounts lookup;
  std::array<OperationCounts, 3> test{};  ///< by accel::PrimitiveKind
  OperationCounts shade;
  OperationCounts light;
  OperationCounts texel;
  OperationCounts pixel;
};

/// Restores the thread's counters when it ends, so that what is computed meanwhile is not counted.
class Uncounted {
 public:
  Uncounted() : saved_(accel::operation_counts()) {}
  Uncounted(const Uncounted&) = delete;
  Uncounted& operator=(const Uncounted&) = delete;
  ~Uncounted() { accel::operation_counts() = saved_; }

 private:
  OperationCounts saved_;
};

/// Divides the operations of a counting render among the kinds of step.
class CountingRecorder {
 public:
  CountingRecorder(const accel::Structure& structure, bool mailboxes)
      : triangles_(structure.triangles()),
        topology_(structure.topology()),
        instances_(dynamic_cast<const accel::StructureOf<accel::TwoLevelBvh>*>(&structure)),
        after_leaf_(after_leaf(accel::traversal_of(structure))),
        mailboxes_(mailboxes),
        mark_(accel::operation_counts()) {}

  void begin_pixel() {}

  void phase(program::Phase phase, program::RayKind kind) {
    close();
    if (phase == program::Phase::shade && nearest_wanted_ && best_->found()) {
      // After a hit closest() ends with dividing three edge functions by their sum: a part of shading.
      current_->divide -= 3;
      buckets_.shade.divide += 3;
    }
    nearest_wanted_ = false;
    current_ = &bucket(phase, kind);
  }

  void ray(program::RayKind kind, std::uint32_t /*bounce*/, const accel::Ray& ray) {
    close();
    ++steps_.rays[static_cast<std::size_t>(kind)];
    current_ = &buckets_.ray[static_cast<std::size_t>(kind)];
    nearest_wanted_ = kind != program::RayKind::shadow;
    const Uncounted uncounted;
    ray_ = ray;
    setup_.emplace(ray);
    accel::NullVisitor nobody;
    best_.emplace(*setup_, accel::HitFilter(triangles_, nobody));
  }

  void branch(std::uint32_t /*node*/) {
    close();
    ++steps_.branches;
    current_ = &buckets_.branch;
  }

  void transform(std::uint32_t node) {
    close();
    ++steps_.transforms;
    current_ = &buckets_.transform;
    const Uncounted uncounted;
    const accel::TwoLevelBvh& tree = instances_->concrete();
    const accel::Instance& instance = tree.instances()[tree.instance_of()[node]];
    setup_.emplace(instance.in_mesh<Counted>(ray_));
    best_->first = instance.first();
  }

  void leaf(std::uint32_t node, std::uint32_t tests, std::uint32_t entries) {
    mailed_leaf(node, tests, entries, nullptr);
  }

  /// The counters since the last event include both the walk to this leaf and its tests. To separate the two,
  /// the tests are done once more here.
  void mailed_leaf(std::uint32_t node, std::uint32_t read, std::uint32_t /*entries*/,
                   const std::uint32_t* tested) {
    ++steps_.leaves;
    OperationCounts others;
    {
      const Uncounted uncounted;
      const std::uint32_t first = topology_.nodes[node].first;
      for (std::uint32_t i = 0; i < read; ++i) {
        if (tested != nullptr && ((tested[i / 32] >> (i % 32)) & 1U) == 0) {
          continue;
        }
        const std::uint32_t id = topology_.entries[first + i];
        const OperationCounts before = accel::operation_counts();
        accel::intersect_primitive(*setup_, triangles_, id, *best_);
        const OperationCounts spent = accel::operation_counts() - before;
        const auto kind = static_cast<std::size_t>(triangles_.kind(id));
        ++tests_[kind];
        ++steps_.tests;
        buckets_.test[kind] += spent;
        others += spent;
      }
    }
    if (mailboxes_) {
      steps_.lookups += read;
      buckets_.lookup.integer += read;
      others.integer += read;
    }
    *current_ += (accel::operation_counts() - mark_) - others;
    mark_ = accel::operation_counts();
    if (after_leaf_ != nullptr) {
      current_ = &(buckets_.*after_leaf_);
    }
  }

  void shade(std::uint32_t /*material*/) { ++steps_.shades; }
  void light(std::uint32_t /*light*/) { ++steps_.lights; }
  void texel(std::uint32_t /*texture*/, std::uint32_t /*texel*/) { ++steps_.texels; }

  /// Operations that follow are not counted.
  void end() { close(); }

  [[nodiscard]] const Buckets& buckets() const { return buckets_; }
  [[nodiscard]] const program::LogTotals& steps() const { return steps_; }
  [[nodiscard]] const std::array<std::uint64_t, 3>& tests() const { return tests_; }

 private:
  using Bucket = OperationCounts Buckets::*;

  /// The step that operations after a leaf belong to; null: no step.
  static Bucket after_leaf(accel::Traversal traversal) {
    switch (traversal) {
      case accel::Traversal::octree:
      case accel::Traversal::bsp_recursive:
      case accel::Traversal::bvh_two:
      case accel::Traversal::bvh_four:
      case accel::Traversal::bvh_six:
      case accel::Traversal::bvh_eight:
      case accel::Traversal::bvh_eight_quantised:
        return &Buckets::branch;  // the walk of its parent continues
      case accel::Traversal::bsp_push_point:
      case accel::Traversal::grid:
        return &Buckets::leaf;
      case accel::Traversal::none:
        return nullptr;
    }
    throw sim::InternalError("operation mix: an unknown traversal");
  }

  OperationCounts& bucket(program::Phase phase, program::RayKind kind) {
    switch (phase) {
      case program::Phase::ray:
        return buckets_.ray[static_cast<std::size_t>(kind)];
      case program::Phase::shade:
        return buckets_.shade;
      case program::Phase::texel:
        return buckets_.texel;
      case program::Phase::light:
        return buckets_.light;
      case program::Phase::pixel:
        return buckets_.pixel;
    }
    throw sim::InternalError("operation mix: an unknown phase");
  }

  void close() {
    *current_ += accel::operation_counts() - mark_;
    mark_ = accel::operation_counts();
  }

  const accel::TriangleSet& triangles_;
  const accel::Topology& topology_;
  const accel::StructureOf<accel::TwoLevelBvh>* instances_;  // null in other structures
  Bucket after_leaf_;
  bool mailboxes_;
  Buckets buckets_;
  program::LogTotals steps_;
  std::array<std::uint64_t, 3> tests_{};
  OperationCounts mark_;
  OperationCounts* current_ = &buckets_.pixel;
  bool nearest_wanted_ = false;
  accel::Ray ray_;  // in the scene's coordinates
  std::optional<accel::RaySetup<Counted>> setup_;
  std::optional<accel::Best<Counted>> best_;
};

/// What the sampling of a texel does beside the interpolation of its coordinates, counted by hand because
/// scenes::sample_nearest is compiled for doubles only: per coordinate the fraction (an addition), its
/// scaling (a multiplication), rounding, a wrap and a clamp (integers); the texel's number (two integers);
/// three table look-ups of its channels (integers).
constexpr OperationMix texel_sampling{2000, 2000, 0, 0, 0, 11000};

/// Converting a finished pixel, counted by hand: three channels are scaled, clamped at both ends and rounded,
/// and packed into one word.
constexpr OperationMix pixel_conversion{0, 3000, 0, 0, 6000, 5000};

/// Of every width of a bounding volume hierarchy, measured with 2 children.
constexpr OperationMix bringing_into_a_mesh{34783, 33022, 6000, 0, 37605, 3934};

/// A node taken as one voxel, by hand from accel/octree_cut.h: its size (an addition, two products, three
/// comparisons), the nearest triangle's t compared, the covered share (the form's six products and five sums,
/// the area, a comparison, a root, over the projection, compared), and the voxel's number looked up.
constexpr OperationMix voxel_cut{6000, 10000, 0, 1000, 6000, 2000};

/// Asking whether a hit counts, by hand from accel/cut_outs.h: three quotients, the corners' weights, and the
/// texel's alpha times the material's compared with the cut-off.
constexpr OperationMix asking{0, 1000, 3000, 0, 1000, 0};

/// Measured by measure_gaussians().
constexpr OperationMix meeting{22000, 30000, 1000, 0, 1000, 0};
constexpr OperationMix collecting{26000, 40000, 0, 0, 2000, 0};
/// Its place among the nearest: a search among 16.
constexpr OperationMix placing{0, 0, 0, 0, 4000, 0};

OperationMix sum(const OperationMix& a, const OperationMix& b) {
  return {a.add + b.add,         a.multiply + b.multiply, a.divide + b.divide, a.square_root + b.square_root,
          a.compare + b.compare, a.integer + b.integer};
}

}  // namespace

OperationMix mean_mix(const accel::OperationCounts& counts, std::uint64_t steps) {
  const auto each = [steps](std::uint64_t count) {
    return steps == 0 ? 0 : static_cast<std::int64_t>((count * 1000 + steps / 2) / steps);
  };
  return {each(counts.add),         each(counts.multiply), each(counts.divide),
          each(counts.square_root), each(counts.compare),  each(counts.integer)};
}

MeasuredMixes measure_operation_mixes(const scenes::Scene& scene, const accel::TriangleSet& triangles,
                                      const accel::Structure& structure,
                                      const program::RenderOptions& options) {
  const scenes::ImagePlane plane = program::image_plane(scene.camera, options);
  const program::Emitters emitters =
      options.integrator == program::Integrator::path ? program::Emitters(scene) : program::Emitters();
  accel::Mailboxed<CountingRecorder> recorder(structure, options.mailboxes);
  const auto trace = [&]<class Recorder>(Recorder& visitor) {
    accel::visit_structure(structure, [&](const auto& concrete) {
      using Concrete = std::remove_cvref_t<decltype(concrete)>;
      program::Tracer<Counted, Concrete, Recorder> tracer(scene, concrete, emitters, plane, options, visitor);
      for (std::uint32_t y = 0; y < options.height; ++y) {
        for (std::uint32_t x = 0; x < options.width; ++x) {
          static_cast<void>(tracer.trace(x, y));
        }
      }
    });
  };
  if (options.mailboxes) {
    recorder.prepare(triangles.size());
    trace(recorder);
  } else {
    trace(static_cast<CountingRecorder&>(recorder));
  }
  recorder.end();

  const Buckets& buckets = recorder.buckets();
  MeasuredMixes measured;
  measured.steps = recorder.steps();
  const program::LogTotals& steps = measured.steps;
  for (std::size_t kind = 0; kind < program::ray_kinds; ++kind) {
    measured.mixes.ray[kind] = mean_mix(buckets.ray[kind], steps.rays[kind]);
  }
  measured.mixes.branch = mean_mix(buckets.branch, steps.branches);
  measured.mixes.transform = mean_mix(buckets.transform, steps.transforms);
  measured.mixes.leaf = mean_mix(buckets.leaf, steps.leaves);
  measured.mixes.lookup = mean_mix(buckets.lookup, steps.lookups);
  measured.tests = recorder.tests();
  const auto test = [&](accel::PrimitiveKind kind) {
    const auto k = static_cast<std::size_t>(kind);
    return mean_mix(buckets.test[k], measured.tests[k]);
  };
  measured.mixes.test = test(accel::PrimitiveKind::triangle);
  measured.mixes.sphere_test = test(accel::PrimitiveKind::sphere);
  measured.mixes.cone_test = test(accel::PrimitiveKind::cone);
  measured.mixes.shade = mean_mix(buckets.shade, steps.shades);
  measured.mixes.light = mean_mix(buckets.light, steps.lights);
  if (steps.texels > 0) {
    measured.mixes.texel = sum(mean_mix(buckets.texel, steps.texels), texel_sampling);
  }
  measured.mixes.pixel =
      sum(mean_mix(buckets.pixel, std::uint64_t{options.width} * options.height), pixel_conversion);
  return measured;
}

std::array<OperationMix, 2> measure_gaussians() {
  scenes::Gaussians one;
  one.shapes.emplace_back();
  one.degree = scenes::largest_degree;
  one.coefficients.assign(std::size_t{3} * one.terms(), 0.0F);
  const accel::Ray ray{{0.25, 0.5, -8.0}, {0.0, 0.0, 1.0}};
  OperationCounts before = accel::operation_counts();
  const Counted squared = accel::least_squared<Counted>(one.shapes[0], ray);
  static_cast<void>(squared <= Counted(1.0));
  const OperationCounts meeting_one = accel::operation_counts() - before;
  before = accel::operation_counts();
  program::Collected<Counted> light;
  program::collect(one, {1.0, 0, squared.value()}, program::Vec3<Counted>(ray.direction), light);
  static_cast<void>(light.through < Counted(program::least_through));
  const std::uint64_t records = one.records() - 1;
  return {sum(mean_mix(meeting_one, 1), placing), mean_mix(accel::operation_counts() - before, records)};
}

MeasuredWalks measure_walks(const accel::Structure& structure, std::span<const accel::Ray> rays) {
  CountingRecorder recorder(structure, false);
  accel::visit_structure(structure, [&](const auto& concrete) {
    for (const accel::Ray& ray : rays) {
      recorder.ray(program::RayKind::camera, 0, ray);
      static_cast<void>(concrete.template closest<Counted>(ray, recorder));
    }
  });
  recorder.end();
  const Buckets& buckets = recorder.buckets();
  OperationCounts tests;
  for (const OperationCounts& kind : buckets.test) {
    tests += kind;
  }
  return {buckets.ray[0], buckets.branch, buckets.leaf, tests, recorder.steps()};
}

namespace {

/// The mixes in which the traversals differ.
using RayMixes = std::array<OperationMix, program::ray_kinds>;

struct WalkMixes {
  RayMixes ray;
  OperationMix branch;
  OperationMix leaf;
  OperationMix test;
};

OperationMixes with_shading(const WalkMixes& walk) {
  return {.ray = walk.ray,
          .branch = walk.branch,
          .transform = bringing_into_a_mesh,
          .leaf = walk.leaf,
          .lookup = {0, 0, 0, 0, 0, 1000},
          .test = walk.test,
          .sphere_test = {19209, 11645, 1273, 273, 5479, 0},
          .cone_test = {34500, 32061, 1843, 204, 6942, 0},
          .shade = {73624, 93477, 7000, 4000, 33812, 0},
          .light = {41000, 68957, 2000, 1000, 6000, 0},
          .path_shade = {141978, 177943, 12635, 7863, 68726, 48446},
          .path_light = {30447, 51625, 1414, 707, 4241, 0},
          .texel = {6000, 11000, 0, 0, 0, 11000},
          .pixel = pixel_conversion,
          .cut = voxel_cut,
          .any_hit = asking,
          .meet = sum(meeting, placing),
          .collect = collecting};
}

}  // namespace

const OperationMixes& operation_mixes(accel::Traversal traversal) {
  // At a ray's start every width of a bounding volume hierarchy does the same work.
  static constexpr RayMixes bvh_rays = {{{32207, 35790, 7000, 1000, 39305, 8166},
                                         {36000, 34000, 6000, 0, 44000, 6473},
                                         {44182, 55183, 7000, 1000, 50000, 7792},
                                         {45000, 59000, 7000, 2000, 50000, 7003},
                                         {52146, 66428, 8000, 3000, 51282, 40279}}};
  // Columns: add, multiply, divide, square root, compare, integer. Rows: camera, shadow, reflected,
  // refracted, scattered ray; branch; leaf; test.
  static const std::array<OperationMixes, accel::traversals> table = {
      with_shading({.ray = {{{20154, 20154, 7000, 1000, 34000, 3000},
                             {22000, 16000, 6000, 0, 38000, 473},
                             {30182, 37183, 7000, 1000, 44000, 1792},
                             {31000, 41000, 7000, 2000, 44000, 1003},
                             {38146, 48428, 8000, 3000, 45282, 34279}}},
                    .branch = {3916, 3004, 0, 0, 8618, 6051},
                    .leaf = {},
                    .test = {18996, 12774, 111, 0, 5186, 0}}),
      with_shading({.ray = {{{20154, 20154, 7000, 1000, 34000, 10749},
                             {22000, 16000, 6000, 0, 38000, 9473},
                             {30182, 37183, 7000, 1000, 44000, 10792},
                             {31000, 41000, 7000, 2000, 44000, 10003},
                             {38146, 48428, 8000, 3000, 45282, 43279}}},
                    .branch = {1235, 1001, 0, 0, 1841, 1255},
                    .leaf = {},
                    .test = {18787, 12612, 87, 0, 4799, 0}}),
      with_shading({.ray = {{{25320, 22737, 9583, 1000, 36583, 3000},
                             {28000, 19000, 9000, 0, 41000, 473},
                             {36182, 40183, 10000, 1000, 47000, 1792},
                             {37000, 44000, 10000, 2000, 47000, 1003},
                             {44146, 51428, 11000, 3000, 48282, 34279}}},
                    .branch = {0, 0, 0, 0, 1000, 558},
                    .leaf = {8564, 1708, 5969, 0, 7713, 995},
                    .test = {18787, 12612, 87, 0, 4799, 0}}),
      with_shading({.ray = {{{32092, 32092, 9583, 1000, 43356, 27853},
                             {36317, 30317, 9000, 0, 49317, 27263},
                             {44455, 51456, 10000, 1000, 55273, 29856},
                             {45229, 55229, 10000, 2000, 55229, 28236},
                             {52557, 62839, 11000, 3000, 56693, 61627}}},
                    .branch = {},
                    .leaf = {972, 963, 0, 0, 2974, 3920},
                    .test = {18998, 12776, 111, 0, 5208, 0}}),
      with_shading({.ray = {{{9163, 13163, 4000, 1000, 9000, 0},
                             {11000, 9062, 3000, 0, 13000, 0},
                             {19209, 30222, 4000, 1000, 19000, 0},
                             {20000, 34000, 4000, 2000, 19000, 0},
                             {27256, 41565, 5009, 3018, 20282, 32882}}},
                    .branch = {},
                    .leaf = {},
                    .test = {18014, 12011, 0, 0, 3328, 0}}),
      with_shading({.ray = bvh_rays,
                    .branch = {12037, 12039, 0, 0, 15188, 1063},
                    .leaf = {},
                    .test = {21123, 14429, 347, 0, 9159, 0}}),
      with_shading({.ray = bvh_rays,
                    .branch = {24038, 24042, 0, 0, 29525, 1209},
                    .leaf = {},
                    .test = {21260, 14536, 362, 0, 9421, 0}}),
      with_shading({.ray = bvh_rays,
                    .branch = {41122, 41127, 0, 0, 42764, 51070},
                    .leaf = {},
                    .test = {21242, 14522, 360, 0, 9389, 0}}),
      with_shading({.ray = bvh_rays,
                    .branch = {46224, 46230, 0, 0, 55658, 1306},
                    .leaf = {},
                    .test = {21274, 14546, 364, 0, 9447, 0}}),
      with_shading({.ray = bvh_rays,
                    .branch = {52196, 52203, 0, 0, 55652, 52647},
                    .leaf = {},
                    .test = {21195, 14485, 355, 0, 9298, 0}}),
  };
  return table[static_cast<std::size_t>(traversal)];
}

}  // namespace marti::processors::cost
