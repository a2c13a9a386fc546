#include "processors/operation_mix.h"

#include <optional>

#include "accel/intersect.h"
#include "accel/structure.h"
#include "accel/watertight.h"
#include "processors/program/recorder.h"
#include "processors/program/tracer.h"
#include "sim/error.h"

namespace marti::processors {

namespace {

using accel::Counted;
using accel::OperationCounts;

struct Buckets {
  std::array<OperationCounts, ray_kinds> ray{};
  OperationCounts branch;
  std::array<OperationCounts, 3> test{};  ///< by accel::PrimitiveKind
  OperationCounts shade;
  OperationCounts light;
  OperationCounts texel;
  OperationCounts pixel;
};

/// Takes its own arithmetic out of the thread's counters again.
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
  CountingRecorder(const accel::TriangleSet& triangles, const accel::Topology& topology)
      : triangles_(triangles), topology_(topology), mark_(accel::operation_counts()) {}

  void begin_pixel() {}

  void phase(Phase phase, RayKind kind) {
    close();
    if (phase == Phase::shade && nearest_wanted_ && best_->found()) {
      // The last thing closest() does after a hit is to divide three edge functions by their sum.
      current_->divide -= 3;
      buckets_.shade.divide += 3;
    }
    nearest_wanted_ = false;
    current_ = &bucket(phase, kind);
  }

  void ray(RayKind kind, std::uint32_t /*bounce*/, const accel::Ray& ray) {
    close();
    ++steps_.rays[static_cast<std::size_t>(kind)];
    current_ = &buckets_.ray[static_cast<std::size_t>(kind)];
    nearest_wanted_ = kind != RayKind::shadow;
    const Uncounted uncounted;
    setup_.emplace(ray);
    best_.emplace(*setup_);
  }

  void branch(std::uint32_t /*node*/) {
    close();
    ++steps_.branches;
    current_ = &buckets_.branch;
  }

  /// The tests were done since the last event, with the walk to this leaf. They are done once more here to
  /// tell the two apart.
  void leaf(std::uint32_t node, std::uint32_t tests, std::uint32_t /*entries*/) {
    ++steps_.leaves;
    steps_.tests += tests;
    OperationCounts of_tests;
    {
      const Uncounted uncounted;
      const std::uint32_t first = topology_.nodes[node].first;
      for (std::uint32_t i = 0; i < tests; ++i) {
        const std::uint32_t id = topology_.entries[first + i];
        const OperationCounts before = accel::operation_counts();
        accel::intersect_primitive(*setup_, triangles_, id, *best_);
        const OperationCounts spent = accel::operation_counts() - before;
        const auto kind = static_cast<std::size_t>(triangles_.kind(id));
        ++tests_[kind];
        buckets_.test[kind] += spent;
        of_tests += spent;
      }
    }
    *current_ += (accel::operation_counts() - mark_) - of_tests;
    mark_ = accel::operation_counts();
    if (topology_.nodes.size() > 1) {
      current_ = &buckets_.branch;  // what follows is its parent going on
    }
  }

  void shade(std::uint32_t /*material*/) { ++steps_.shades; }
  void light(std::uint32_t /*light*/) { ++steps_.lights; }
  void texel(std::uint32_t /*texture*/, std::uint32_t /*texel*/) { ++steps_.texels; }

  /// Operations that follow count for nothing.
  void end() { close(); }

  [[nodiscard]] const Buckets& buckets() const { return buckets_; }
  [[nodiscard]] const LogTotals& steps() const { return steps_; }
  [[nodiscard]] const std::array<std::uint64_t, 3>& tests() const { return tests_; }

 private:
  OperationCounts& bucket(Phase phase, RayKind kind) {
    switch (phase) {
      case Phase::ray:
        return buckets_.ray[static_cast<std::size_t>(kind)];
      case Phase::shade:
        return buckets_.shade;
      case Phase::texel:
        return buckets_.texel;
      case Phase::light:
        return buckets_.light;
      case Phase::pixel:
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
  Buckets buckets_;
  LogTotals steps_;
  std::array<std::uint64_t, 3> tests_{};
  OperationCounts mark_;
  OperationCounts* current_ = &buckets_.pixel;
  bool nearest_wanted_ = false;
  std::optional<accel::RaySetup<Counted>> setup_;
  std::optional<accel::Best<Counted>> best_;
};

/// What the sampling of a texel does beside the interpolation of its coordinates, counted by hand because
/// scenes::sample_nearest is compiled for doubles only: per coordinate the fraction (an addition), its
/// scaling (a multiplication), rounding, a wrap and a clamp (integers); the texel's number (two integers);
/// three table look-ups of its channels (integers).
constexpr OperationMix texel_sampling{2000, 2000, 0, 0, 0, 11000};

/// A finished pixel, by hand: three channels are scaled, clamped at both ends and rounded, and packed
/// into one word.
constexpr OperationMix pixel_conversion{0, 3000, 0, 0, 6000, 5000};

/// A small node, by hand from accel/octree_cut.h: its size (an addition, two products, three comparisons),
/// the nearest triangle's t compared, the covered share (the form's six products and five sums, the area, a
/// comparison, a root, over the projection, compared), and the voxel's number looked up.
constexpr OperationMix voxel_cut{6000, 10000, 0, 1000, 6000, 2000};

OperationMix sum(const OperationMix& a, const OperationMix& b) {
  return {a.add + b.add,         a.multiply + b.multiply, a.divide + b.divide, a.square_root + b.square_root,
          a.compare + b.compare, a.integer + b.integer};
}

OperationMix mean(const OperationCounts& counts, std::uint64_t steps) {
  const auto each = [steps](std::uint64_t count) {
    return steps == 0 ? 0 : static_cast<std::int64_t>((count * 1000 + steps / 2) / steps);
  };
  return {each(counts.add),         each(counts.multiply), each(counts.divide),
          each(counts.square_root), each(counts.compare),  each(counts.integer)};
}

}  // namespace

MeasuredMixes measure_operation_mixes(const scenes::Scene& scene, const accel::TriangleSet& triangles,
                                      const accel::Structure& structure, const RenderOptions& options) {
  const scenes::ImagePlane plane = scene.camera.image_plane(options.width, options.height);
  CountingRecorder recorder(triangles, structure.topology());
  accel::visit_structure(structure, [&](const auto& concrete) {
    using Concrete = std::remove_cvref_t<decltype(concrete)>;
    Tracer<Counted, Concrete, CountingRecorder> tracer(scene, concrete, plane, options, recorder);
    for (std::uint32_t y = 0; y < options.height; ++y) {
      for (std::uint32_t x = 0; x < options.width; ++x) {
        static_cast<void>(tracer.trace(x, y));
      }
    }
  });
  recorder.end();

  const Buckets& buckets = recorder.buckets();
  MeasuredMixes measured;
  measured.steps = recorder.steps();
  const LogTotals& steps = measured.steps;
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    measured.mixes.ray[kind] = mean(buckets.ray[kind], steps.rays[kind]);
  }
  measured.mixes.branch = mean(buckets.branch, steps.branches);
  measured.tests = recorder.tests();
  const auto test = [&](accel::PrimitiveKind kind) {
    const auto k = static_cast<std::size_t>(kind);
    return mean(buckets.test[k], measured.tests[k]);
  };
  measured.mixes.test = test(accel::PrimitiveKind::triangle);
  measured.mixes.sphere_test = test(accel::PrimitiveKind::sphere);
  measured.mixes.cone_test = test(accel::PrimitiveKind::cone);
  measured.mixes.shade = mean(buckets.shade, steps.shades);
  measured.mixes.light = mean(buckets.light, steps.lights);
  if (steps.texels > 0) {
    measured.mixes.texel = sum(mean(buckets.texel, steps.texels), texel_sampling);
  }
  measured.mixes.pixel =
      sum(mean(buckets.pixel, std::uint64_t{options.width} * options.height), pixel_conversion);
  return measured;
}

const OperationMixes& operation_mixes() {
  // Columns: add, multiply, divide, square root, compare, integer.
  static constexpr OperationMixes table{
      .ray = {{
          {20154, 20154, 7000, 1000, 34000, 3000},  // camera
          {22000, 16000, 6000, 0, 38000, 473},      // shadow
          {30182, 37183, 7000, 1000, 44000, 1792},  // reflection
          {31000, 41000, 7000, 2000, 44000, 1003},  // refraction
      }},
      .branch = {3916, 3004, 0, 0, 8618, 6051},
      .leaf = {},
      .test = {18996, 12774, 111, 0, 5186, 0},
      .sphere_test = {19209, 11645, 1273, 273, 5479, 0},
      .cone_test = {34500, 32061, 1843, 204, 6942, 0},
      .shade = {73624, 93477, 7000, 4000, 33812, 0},
      .light = {41000, 68957, 2000, 1000, 6000, 0},
      .texel = {6000, 11000, 0, 0, 0, 11000},
      .pixel = pixel_conversion,
      .cut = voxel_cut,
  };
  return table;
}

}  // namespace marti::processors
