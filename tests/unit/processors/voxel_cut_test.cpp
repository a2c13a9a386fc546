// The voxel cut against the exact walk, closed forms and the rules of its log.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <glm/geometric.hpp>

#include "accel/voxel_cover.h"
#include "processors/program/log_rules.h"
#include "processors/program/recorder.h"
#include "processors/program/tracer.h"
#include "processors/program/voxel_average.h"
#include "processors/replay/replay.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::processors {

using namespace machine;
using namespace program;
using namespace replay;

namespace {

using test::Built;
using test::same_bytes;

double real(double lo, double hi) { return lo + (hi - lo) * *rc::gen::inRange(0, 1'000'001) / 1e6; }
glm::dvec3 point(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }

const accel::Octree& octree_of(const Built& built) {
  return dynamic_cast<const accel::StructureOf<accel::Octree>&>(*built.structure).concrete();
}

// A scene seen from `factor` times as far away.
scenes::Scene far_away(const char* source, double factor) {
  scenes::Scene scene = scenes::make_procedural(source);
  scene.camera.eye = scene.camera.at + factor * (scene.camera.eye - scene.camera.at);
  return scene;
}

double area_of(const std::vector<glm::dvec3>& polygon) {
  glm::dvec3 sum(0.0);
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    sum += glm::cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
  }
  return 0.5 * glm::length(sum);
}

RC_GTEST_PROP(VoxelCover, PiecesOfATriangleAddUpToIt, ()) {
  const glm::dvec3 a = point(1.0);
  const glm::dvec3 b = point(1.0);
  const glm::dvec3 c = point(1.0);
  const glm::dvec3 split = point(1.0);
  double sum = 0.0;
  std::vector<glm::dvec3> piece;
  for (unsigned box = 0; box < 8; ++box) {
    glm::dvec3 lo(-1.0);
    glm::dvec3 hi(1.0);
    for (int axis = 0; axis < 3; ++axis) {
      ((box >> axis & 1U) != 0 ? lo : hi)[axis] = split[axis];
    }
    accel::clip_to_box({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}, lo, hi, piece);
    RC_ASSERT(piece.size() <= 9U);
    sum += area_of(piece);
    for (const glm::dvec3& p : piece) {
      for (int axis = 0; axis < 3; ++axis) {
        RC_ASSERT(p[axis] >= lo[axis] - 1e-15 && p[axis] <= hi[axis] + 1e-15);
      }
    }
  }
  RC_ASSERT(std::abs(sum - area_of({a, b, c})) < 1e-12);
}

RC_GTEST_PROP(VoxelCover, SeesAFlatSurfaceExactlyAndNoSurfacesTooSmall, ()) {
  const auto random_unit = [] {
    const glm::dvec3 v = point(1.0);
    return glm::normalize(v + glm::dvec3(0.0, 0.0, glm::length(v) < 0.01 ? 2.0 : 0.0));
  };
  const glm::dvec3 d = random_unit();
  const auto surfaces = *rc::gen::inRange(1, 6);
  accel::SymmetricForm<double> form{};
  double area = 0.0;
  double seen = 0.0;
  for (int i = 0; i < surfaces; ++i) {
    const glm::dvec3 n = random_unit();
    const double a = real(0.01, 1.0);
    const double products[6] = {n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z};
    for (std::size_t k = 0; k < 6; ++k) {
      form[k] += a * products[k];
    }
    area += a;
    seen += a * std::abs(glm::dot(n, d));
  }
  accel::VoxelCover cover;
  cover.area = static_cast<float>(area);
  std::transform(form.begin(), form.end(), cover.form.begin(),
                 [](double v) { return static_cast<float>(v); });
  const double estimate = cover.seen(accel::products_of(std::array<double, 3>{d.x, d.y, d.z}));
  RC_ASSERT(estimate >= seen - 1e-3 * area);
  RC_ASSERT(estimate <= area * (1.0 + 1e-5));
  if (surfaces == 1) {
    RC_ASSERT(std::abs(estimate - seen) < 1e-3 * area);
  }
}

/// Every node with what happened there.
struct Visits : NullRecorder {
  std::vector<std::uint64_t> nodes;
  void branch(std::uint32_t node) { nodes.push_back(node); }
  void leaf(std::uint32_t node, std::uint32_t tests, std::uint32_t /*entries*/) {
    nodes.push_back(std::uint64_t{tests} << 32U | node);
  }
};

RC_GTEST_PROP(CutOctree, WithoutPixelsIsTheExactWalk, ()) {
  static const Built built(scenes::make_procedural("teapot:4"), "octree");
  static const VoxelAverages averages = VoxelAverages::build(built.scene, octree_of(built), 1, 1);
  const CutStructure cut(octree_of(built), averages, 1.0);
  accel::Ray ray;
  // Now and then from so far away that the slow walk is taken.
  ray.origin = point(*rc::gen::element(1.0, 5.0, 20.0, 5000.0));
  const glm::dvec3 to = point(3.0) - ray.origin;
  RC_PRE(glm::length(to) > 1e-3);
  ray.direction = glm::normalize(to);
  Visits exact;
  Visits visits;
  const accel::Hit hit = octree_of(built).closest(ray, exact);
  const accel::CutHit other = cut.closest(ray, {.pixel = 1e-200, .path = real(0.0, 100.0)}, visits);
  RC_ASSERT(other.voxel == accel::no_voxel);
  RC_ASSERT(other.hit.primitive == hit.primitive);
  RC_ASSERT(other.hit.t == hit.t);
  RC_ASSERT(visits.nodes == exact.nodes);
}

TEST(VoxelCut, ACoarseTriangleSeenFromNearIsUnchanged) {
  scenes::Scene scene = test::looking_down(2.0);
  scene.background = {0.1, 0.2, 0.3};
  scene.materials.emplace_back();
  scene.ambient = {0.5, 0.5, 0.5};
  scene.positions = {{-1.0, -1.0, 0.0}, {1.0, -1.0, 0.3}, {0.0, 1.0, -0.2}};
  scene.triangles.push_back({{0, 1, 2}, 0, 0});
  const Built built(scene, "octree");
  RenderOptions options{.width = 40, .height = 40, .record = true};
  const Frame exact = built.render(options);
  options.voxel_cut = 1.0;
  const Frame cut = built.render(options);
  EXPECT_TRUE(same_bytes(exact.image, cut.image));
  EXPECT_EQ(exact.hit_hash, cut.hit_hash);
  EXPECT_EQ(cut.voxels, 0U) << "no cell can be below a pixel";
  EXPECT_EQ(totals_of(*exact.log).bytes, totals_of(*cut.log).bytes);
}

// A box of edges e about the origin, its sides along x of material 0, the others of material 1.
scenes::Scene box_scene(const glm::dvec3& e) {
  scenes::Scene scene = test::looking_down(1e6);
  scene.materials.resize(2);
  const glm::dvec3 h = 0.5 * e;
  const auto corner = [&](int i) {
    return glm::dvec3((i & 1) != 0 ? h.x : -h.x, (i & 2) != 0 ? h.y : -h.y, (i & 4) != 0 ? h.z : -h.z);
  };
  const auto quad = [&](int a, int b, int c, int d, std::uint32_t material) {
    test::add_quad(scene, corner(a), corner(b), corner(c), corner(d), material);
  };
  quad(0, 4, 6, 2, 0);
  quad(1, 3, 7, 5, 0);
  quad(0, 1, 5, 4, 1);
  quad(2, 6, 7, 3, 1);
  quad(0, 2, 3, 1, 1);
  quad(4, 5, 7, 6, 1);
  scene.ambient = {0.25, 0.25, 0.25};
  scenes::Light light;
  light.kind = scenes::LightKind::directional;
  light.direction = {0.0, 0.0, -1.0};
  light.color = {0.5, 1.0, 2.0};
  scene.lights.push_back(light);
  return scene;
}

// Far below a pixel and lit from the eye, a box shows the mean of its materials, by area: the eye is in the
// direction of one of its axes, about which the areas are symmetric, so the mean normal faces it.
RC_GTEST_PROP(VoxelCut, ABoxFarBelowAPixelHasItsAverageColour, ()) {
  const glm::dvec3 e(real(0.5, 2.0), real(0.5, 2.0), real(0.5, 2.0));
  scenes::Scene scene = box_scene(e);
  for (scenes::Material& material : scene.materials) {
    material.color = {real(0.0, 1.0), real(0.0, 1.0), real(0.0, 1.0)};
    material.diffuse = real(0.1, 1.0);
    material.emission = {real(0.0, 0.2), 0.0, 0.0};
  }
  RenderOptions options = test::one_pixel();
  options.voxel_cut = 1.0;
  options.record = true;
  const Frame frame = Built(scene, "octree").render(options);
  RC_ASSERT(frame.rays.voxels[0] == 1U);
  RC_ASSERT(program::fault_of(*frame.log) == "");
  const double sides = 2.0 * e.y * e.z;
  const double others = 2.0 * (e.x * e.y + e.x * e.z);
  const scenes::Material& a = scene.materials[0];
  const scenes::Material& b = scene.materials[1];
  const glm::dvec3 expected =
      (sides * (a.emission + a.color * a.diffuse * (scene.ambient + scene.lights[0].color)) +
       others * (b.emission + b.color * b.diffuse * (scene.ambient + scene.lights[0].color))) /
      (sides + others);
  for (int channel = 0; channel < 3; ++channel) {
    RC_ASSERT(std::abs(frame.image.pixels[0][channel] - expected[channel]) < 1e-5);
  }
}

TEST(VoxelCut, ATeapotFarBelowAPixelHasItsColour) {
  scenes::Scene scene = far_away("teapot:4:pot", 1e5);
  for (scenes::Material& material : scene.materials) {
    material = {};
    material.color = {0.9, 0.6, 0.3};
  }
  scene.lights.clear();
  scene.ambient = {0.5, 0.5, 0.5};
  RenderOptions options = test::one_pixel();
  options.voxel_cut = 1.0;
  // The pixel's only ray may miss so small a pot: look at its middle.
  const Built probe(scene, "octree");
  const scenes::Bounds& box = octree_of(probe).bounds();
  scene.camera.at = 0.5 * (box.lo + box.hi);
  const Frame frame = Built(scene, "octree").render(options);
  EXPECT_EQ(frame.rays.voxels[0], 1U);
  EXPECT_NEAR(frame.image.pixels[0].x, 0.45, 1e-6);
  EXPECT_NEAR(frame.image.pixels[0].y, 0.30, 1e-6);
  EXPECT_NEAR(frame.image.pixels[0].z, 0.15, 1e-6);
}

TEST(VoxelAverages, CountEveryTrianglesAreaOnce) {
  const Built built(scenes::make_procedural("teapot:6:pot"), "octree");
  const VoxelAverages averages = VoxelAverages::build(built.scene, octree_of(built), 1, 2);
  double area = 0.0;
  for (std::uint32_t id = 0; id < built.triangles->size(); ++id) {
    area += area_of(
        {built.triangles->corner(id, 0), built.triangles->corner(id, 1), built.triangles->corner(id, 2)});
  }
  const glm::dvec3 e = octree_of(built).bounds().hi - octree_of(built).bounds().lo;
  const double longest = std::max({e.x, e.y, e.z});
  EXPECT_NEAR(averages.cover(0).area * longest * longest, area, 1e-5 * area);
  const accel::SymmetricForm<float>& form = averages.cover(0).form;
  EXPECT_NEAR(form[0] + form[1] + form[2], averages.cover(0).area, 1e-5 * averages.cover(0).area)
      << "the trace of a sum of n n' over unit normals";
}

class CutFrames : public testing::TestWithParam<const char*> {};

TEST_P(CutFrames, DoNotDependOnThreadsOrRecordingAndKeepTheLogsRules) {
  const Built built(far_away(GetParam(), 6.0), "octree");
  RenderOptions options{.width = 96, .height = 96, .max_depth = 4, .voxel_cut = 2.0, .record = true};
  const Frame one = built.render(options, 1);
  const Frame four = built.render(options, 4);
  EXPECT_TRUE(same_bytes(one.image, four.image));
  EXPECT_EQ(one.hit_hash, four.hit_hash);
  EXPECT_EQ(one.rays.voxels, four.rays.voxels);
  for (std::size_t y = 0; y < one.log->rows.size(); ++y) {
    ASSERT_EQ(one.log->rows[y].words, four.log->rows[y].words);
  }
  ASSERT_EQ(program::fault_of(*one.log), "");
  const LogTotals totals = totals_of(*one.log);
  EXPECT_GT(totals.cuts, 0U);
  EXPECT_EQ(totals.cuts, one.rays.voxels[0] + one.rays.voxels[2] + one.rays.voxels[3]);
  EXPECT_EQ(one.rays.voxels[1], 0U) << "shadow rays are exact";
  EXPECT_EQ(totals.shades, one.rays.hit[0] + one.rays.hit[2] + one.rays.hit[3]);
  options.record = false;
  EXPECT_TRUE(same_bytes(one.image, built.render(options, 2).image));
  for (const glm::vec3& pixel : one.image.pixels) {
    ASSERT_TRUE(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
  }
}

// Up to the voxel at which it ends, a camera ray visits the same nodes as without the cut, in the same order.
TEST_P(CutFrames, VisitTheBeginningOfWhatTheExactFrameVisits) {
  const Built built(far_away(GetParam(), 12.0), "octree");
  RenderOptions options{.width = 96, .height = 96, .max_depth = 1, .shadows = false, .record = true};
  const Frame exact = built.render(options, 2);
  options.voxel_cut = 1.0;
  const Frame cut = built.render(options, 2);
  std::size_t shorter = 0;
  for (std::uint32_t y = 0; y < options.height; ++y) {
    for (std::uint32_t x = 0; x < options.width; ++x) {
      const auto whole = exact.log->pixel(x, y);
      std::size_t at = 0;
      bool ended = false;
      for (const std::uint32_t word : cut.log->pixel(x, y)) {
        const Step step = step_of(word);
        if (step == Step::pass || ended) {
          continue;
        }
        ASSERT_LT(at, whole.size());
        if (step == Step::cut) {
          ASSERT_LE(step_of(whole[at]), Step::leaf);
          ASSERT_EQ(operand_of(whole[at]), operand_of(word));
          ASSERT_GE(cut.log->topology.nodes[operand_of(word)].level, cut.first_voxel_level);
          ended = true;
          ++shorter;
        } else {
          ASSERT_EQ(word, whole[at]);
        }
        ++at;
      }
    }
  }
  EXPECT_GT(shorter, 0U);
  EXPECT_LT(totals_of(*cut.log).tests, totals_of(*exact.log).tests);
}

// The bound on the levels that need averages loses no voxel. Thresholds up to four: one level's worth.
TEST_P(CutFrames, NeedNoVoxelsAboveTheFirstSmallLevel) {
  const Built built(far_away(GetParam(), 12.0), "octree");
  const VoxelAverages all = VoxelAverages::build(built.scene, octree_of(built), 1, 1);
  constexpr std::uint32_t size = 64;
  for (const double threshold : {1.0, 1.2, 1.4, 1.7, 2.0, 2.4, 2.8, 3.4}) {
    const RenderOptions options{.width = size, .height = size, .max_depth = 2, .voxel_cut = threshold};
    const Frame frame = built.render(options, 1);
    ASSERT_GT(frame.first_voxel_level, 1U);
    const CutStructure structure(octree_of(built), all, threshold);
    NullRecorder recorder;
    const Emitters none;
    Tracer<double, CutStructure, NullRecorder> tracer(
        built.scene, structure, none, built.scene.camera.image_plane(size, size), options, recorder);
    for (std::uint32_t y = 0; y < size; ++y) {
      for (std::uint32_t x = 0; x < size; ++x) {
        const Vec3<double> color = tracer.trace(x, y);
        ASSERT_EQ(frame.image.at(x, y), glm::vec3(static_cast<float>(color.x), static_cast<float>(color.y),
                                                  static_cast<float>(color.z)));
      }
    }
    EXPECT_EQ(tracer.rays().voxels, frame.rays.voxels);
  }
}

TEST_P(CutFrames, ReplayTakesTheirSteps) {
  const Built built(far_away(GetParam(), 6.0), "octree");
  const Frame frame = built.render({.width = 48, .height = 48, .voxel_cut = 2.0, .record = true}, 2);
  const LogTotals totals = totals_of(*frame.log);
  MachineConfig machine;
  machine.nodes = 3;
  const MachineResult result = replay::replay(*frame.log, machine);
  EXPECT_EQ(static_cast<std::uint64_t>(result.steps().cuts), totals.cuts);
  EXPECT_EQ(static_cast<std::uint64_t>(result.steps().passes), totals.passes);
  const Frame exact = built.render({.width = 48, .height = 48, .record = true}, 2);
  EXPECT_EQ(result.database_bytes > replay::replay(*exact.log, machine).database_bytes, frame.voxels > 0)
      << "averaged materials are records of the database";
}

INSTANTIATE_TEST_SUITE_P(Procedural, CutFrames, testing::Values("teapot:6", "gears:2", "tetra:4"));

// Cells of a mirror that are far below a pixel do not catch the rays that leave it.
TEST(VoxelCut, AFlatMirrorDoesNotSeeItself) {
  for (const double height : {20.0, 60.0, 200.0}) {
    scenes::Scene scene = test::looking_down(1.0);
    scene.camera.eye = {150.0, 40.0, height};
    scene.background = {1.0, 1.0, 1.0};
    scene.materials.emplace_back();
    scene.materials[0].diffuse = 0.0;
    scene.materials[0].reflection = 0.5;
    constexpr int n = 24;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const glm::dvec3 at(i - n / 2, j - n / 2, 0.0);
        test::add_quad(scene, at, at + glm::dvec3(1, 0, 0), at + glm::dvec3(1, 1, 0),
                       at + glm::dvec3(0, 1, 0), 0);
      }
    }
    // Something above, so that the cells are not as flat as the mirror.
    const glm::dvec3 high(0.0, 0.0, 24.0);
    test::add_quad(scene, high, high + glm::dvec3(1e-3, 0, 0), high + glm::dvec3(1e-3, 1e-3, 0),
                   high + glm::dvec3(0, 1e-3, 0), 0);
    const Frame frame =
        Built(scene, "octree").render({.width = 96, .height = 96, .max_depth = 6, .voxel_cut = 4.0}, 2);
    // Eye rays as oblique as from height 20 meet no voxel, only triangles.
    EXPECT_EQ(frame.rays.voxels[0] > 0, height > 20.0) << height;
    EXPECT_GT(frame.rays.traced[2], 0U);
    EXPECT_EQ(frame.rays.hit[2], 0U) << "a reflected ray met the mirror again, eye at height " << height;
  }
}

TEST(VoxelCut, RefusesWhatItCannotDo) {
  const scenes::Scene scene = scenes::make_procedural("tetra:2");
  const auto refused = [&](const char* kind, double cut) {
    RenderOptions options{.width = 4, .height = 4, .voxel_cut = cut};
    EXPECT_THROW(static_cast<void>(Built(scene, kind).render(options)), sim::UserError) << kind << " " << cut;
  };
  refused("bsp", 1.0);
  refused("grid", 1.0);
  refused("none", 1.0);
  refused("octree", -1.0);
  refused("octree", std::numeric_limits<double>::infinity());
  refused("octree", std::numeric_limits<double>::quiet_NaN());
}

TEST(VoxelCut, AnEmptySceneIsAllBackground) {
  scenes::Scene scene = test::looking_down(1.0);
  scene.background = {0.25, 0.5, 0.75};
  const Frame frame = Built(scene, "octree").render({.width = 2, .height = 2, .voxel_cut = 1e9});
  for (const glm::vec3& pixel : frame.image.pixels) {
    EXPECT_EQ(pixel, glm::vec3(0.25F, 0.5F, 0.75F));
  }
}

}  // namespace
}  // namespace marti::processors
