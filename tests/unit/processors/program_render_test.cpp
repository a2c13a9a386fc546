// Whole frames: the same bytes on any number of threads and with any structure, and logs that keep their
// rules and agree with the counts.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>
#include <set>

#include "processors/program/log_rules.h"
#include "processors/program/recorder.h"
#include "processors/program/tracer.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;
using test::same_bytes;

bool same_rows(const WorkLog& a, const WorkLog& b) {
  if (a.rows.size() != b.rows.size()) {
    return false;
  }
  for (std::size_t y = 0; y < a.rows.size(); ++y) {
    if (a.rows[y].words != b.rows[y].words || a.rows[y].begin != b.rows[y].begin) {
      return false;
    }
  }
  return true;
}

class Frames : public testing::TestWithParam<const char*> {};

struct FrameCase {
  const char* scene;
  std::uint32_t samples = 1;
  bool floats = false;
  Integrator integrator = Integrator::whitted;
};
void PrintTo(const FrameCase& frame, std::ostream* out) { *out << frame.scene; }
class AnyFrames : public testing::TestWithParam<FrameCase> {};

TEST_P(AnyFrames, DoNotDependOnThreadsRecordingOrStructure) {
  const Built octree(scenes::make_procedural(GetParam().scene), "octree");
  RenderOptions options{.width = 45,
                        .height = 37,
                        .max_depth = 4,
                        .integrator = GetParam().integrator,
                        .samples = GetParam().samples,
                        .floats = GetParam().floats,
                        .record = true};
  const Frame one = octree.render(options, 1);
  const Frame four = octree.render(options, 4);
  EXPECT_TRUE(same_bytes(one.image, four.image));
  EXPECT_TRUE(same_rows(*one.log, *four.log));
  EXPECT_EQ(one.hit_hash, four.hit_hash);
  EXPECT_EQ(one.rays.traced, four.rays.traced);
  EXPECT_EQ(program::fault_of(*one.log), "");
  EXPECT_TRUE(std::ranges::equal(totals_of(*one.log).rays, one.rays.traced));
  EXPECT_EQ(one.log->quadrics.size(), octree.scene.quadrics.size());
  EXPECT_EQ(one.log->primitives, octree.scene.triangles.size() + octree.scene.quadrics.size());

  options.record = false;
  const Frame plain = octree.render(options, 2);
  EXPECT_EQ(plain.log, nullptr);
  EXPECT_TRUE(same_bytes(one.image, plain.image));
  EXPECT_EQ(one.hit_hash, plain.hit_hash);

  for (const std::string_view kind : accel::structure_kinds()) {
    const Built built(octree.scene, kind);
    if (kind == "none" && built.triangles->size() > 2000) {
      continue;  // random scenes and small ones compare images with those of brute force
    }
    const Frame other = built.render(options, 2);
    EXPECT_TRUE(same_bytes(one.image, other.image)) << kind;
    EXPECT_EQ(one.hit_hash, other.hit_hash) << kind;
    EXPECT_EQ(one.rays.traced, other.rays.traced) << kind;
    EXPECT_EQ(one.rays.hit, other.rays.hit) << kind;
  }
  EXPECT_GT(one.rays.hit[0], 100U);
}

INSTANTIATE_TEST_SUITE_P(Procedural, AnyFrames,
                         testing::Values(FrameCase{"teapot:4"}, FrameCase{"gears:2"}, FrameCase{"tetra:4"},
                                         FrameCase{"lattice:2"}, FrameCase{"tree:4"}, FrameCase{"balls:2"},
                                         FrameCase{"mount:2"}, FrameCase{"balls:1", 5},
                                         FrameCase{"balls:1", 1, true}, FrameCase{"gears:1", 1, true},
                                         FrameCase{"room:3", 2, false, Integrator::path},
                                         FrameCase{"room:3", 2, false, Integrator::shadow},
                                         FrameCase{"balls:1", 1, true, Integrator::shadow},
                                         FrameCase{"gears:1", 2, false, Integrator::occlusion}));

/// Reads a pixel's words against the order of execution that tracer.h states.
void check_order(std::span<const std::uint32_t> words, const RenderOptions& options) {
  ASSERT_FALSE(words.empty());
  ASSERT_EQ(words[0], make_word(Step::ray, 0)) << "a pixel begins with its camera ray, bounce 0";
  std::uint32_t bounce = 0;  // of the ray whose point is being shaded
  bool shadow = false;       // the ray at hand is a shadow ray
  bool shaded = true;        // no shade since the last camera, reflected or refracted ray
  for (std::size_t at = 0; at < words.size(); at += step_words(words.data() + at)) {
    const Step step = step_of(words[at]);
    const std::uint32_t operand = operand_of(words[at]);
    if (step == Step::ray) {
      const auto kind = ray_kind_of(operand);
      shadow = kind == RayKind::shadow;
      if (shadow) {
        EXPECT_TRUE(shaded) << "a shadow ray belongs to a shaded point";
        EXPECT_EQ(bounce_of(operand), bounce + 1);
      } else {
        EXPECT_EQ(kind == RayKind::camera, at == 0) << "one camera ray per pixel";
        bounce = bounce_of(operand);
        EXPECT_LT(bounce, options.max_depth);
        shaded = false;
      }
    } else if (step == Step::shade) {
      EXPECT_FALSE(shadow || shaded) << "a point is shaded once, after the ray that found it";
      shaded = true;
    } else if (step == Step::light) {
      EXPECT_TRUE(shadow && shaded) << "a light follows its shadow ray";
    } else if (step == Step::partial_leaf) {
      EXPECT_TRUE(shadow) << "only occlusion ends early";
    }
  }
}

/// Counts independently what the log should hold.
struct CountingVisitor : NullRecorder {
  LogTotals totals;
  void branch(std::uint32_t /*node*/) { ++totals.branches; }
  void leaf(std::uint32_t /*node*/, std::uint32_t tests, std::uint32_t /*entries*/) {
    ++totals.leaves;
    totals.tests += tests;
  }
  void ray(RayKind kind, std::uint32_t /*bounce*/, const accel::Ray& /*ray*/) {
    ++totals.rays[static_cast<std::size_t>(kind)];
  }
  void shade(std::uint32_t /*material*/) { ++totals.shades; }
  void light(std::uint32_t /*light*/) { ++totals.lights; }
};

TEST_P(Frames, LogsSayWhatHappened) {
  const Built built(scenes::make_procedural(GetParam()), "octree");
  const RenderOptions options{.width = 64, .height = 48, .max_depth = 4, .record = true};
  const Frame frame = built.render(options, 2);
  const WorkLog& log = *frame.log;
  ASSERT_EQ(program::fault_of(log), "");
  for (std::uint32_t y = 0; y < options.height; ++y) {
    for (std::uint32_t x = 0; x < options.width; ++x) {
      check_order(log.pixel(x, y), options);
    }
  }
  const LogTotals totals = totals_of(log);
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    EXPECT_EQ(totals.rays[kind], frame.rays.traced[kind]);
  }
  EXPECT_EQ(totals.rays[0], 64U * 48U);
  EXPECT_EQ(totals.shades, frame.rays.hit[0] + frame.rays.hit[2] + frame.rays.hit[3]);
  EXPECT_EQ(totals.lights, frame.rays.traced[1] - frame.rays.hit[1]);

  CountingVisitor visitor;
  const Emitters none;
  accel::visit_structure(*built.structure, [&](const auto& concrete) {
    Tracer<double, std::remove_cvref_t<decltype(concrete)>, CountingVisitor> tracer(
        built.scene, concrete, none, built.scene.camera.image_plane(64, 48), options, visitor);
    for (std::uint32_t y = 0; y < 48; ++y) {
      for (std::uint32_t x = 0; x < 64; ++x) {
        static_cast<void>(tracer.trace(x, y));
      }
    }
    EXPECT_EQ(tracer.hit_hash(), frame.hit_hash);
  });
  EXPECT_EQ(totals.branches, visitor.totals.branches);
  EXPECT_EQ(totals.leaves, visitor.totals.leaves);
  EXPECT_EQ(totals.tests, visitor.totals.tests);
  EXPECT_EQ(totals.shades, visitor.totals.shades);
  EXPECT_EQ(totals.lights, visitor.totals.lights);

  const double bytes_per_ray = static_cast<double>(totals.bytes) / static_cast<double>(totals.all_rays());
  RecordProperty("bytes_per_ray", std::to_string(bytes_per_ray));
  EXPECT_LT(bytes_per_ray,
            4.0 * static_cast<double>(totals.all_steps()) / static_cast<double>(totals.all_rays()));
}

TEST_P(Frames, ShrinkWithDepthAndLeastWeight) {
  const Built built(scenes::make_procedural(GetParam()), "octree");
  std::uint64_t before = 0;
  for (const std::uint32_t depth : {1U, 2U, 3U, 5U}) {
    const Frame frame = built.render({.width = 48, .height = 48, .max_depth = depth}, 2);
    EXPECT_GE(frame.rays.all(), before);
    before = frame.rays.all();
    if (depth == 1) {
      EXPECT_EQ(frame.rays.traced[2] + frame.rays.traced[3], 0U);
    }
  }
  for (const double weight : {0.001, 0.05, 0.3, 1.0}) {
    const Frame frame = built.render({.width = 48, .height = 48, .max_depth = 5, .min_weight = weight}, 2);
    EXPECT_LE(frame.rays.all(), before);
    before = frame.rays.all();
  }
}

INSTANTIATE_TEST_SUITE_P(Procedural, Frames, testing::Values("teapot:4", "gears:2", "tetra:4"));

/// A random scene: triangles about the origin, with every kind of material and light.
scenes::Scene random_scene() {
  const auto number = [](int low, int high) { return *rc::gen::inRange(low * 100, high * 100 + 1) / 100.0; };
  const auto point = [&](int size) {
    return glm::dvec3(number(-size, size), number(-size, size), number(-size, size));
  };
  const auto weight = [&] { return *rc::gen::element(0.0, 0.0, 0.3, 0.6, 1.0); };
  scenes::Scene scene = test::looking_down(6.0);
  scene.background = {0.1, 0.2, 0.3};
  scene.ambient = {0.2, 0.2, 0.2};
  for (int i = 0; i < 4; ++i) {
    scenes::Material& material = scene.materials.emplace_back();
    material.diffuse = weight();
    material.reflection = weight();
    material.transmission = weight();
    material.highlight = weight();
    material.shininess = *rc::gen::element(1.0, 7.5, 300.0);
    material.ior = *rc::gen::element(1.0, 1.33, 2.4);
  }
  scene.materials[3].texture = 0;
  scenes::Texture& texture = scene.textures.emplace_back();
  texture.width = 3;
  texture.height = 2;
  texture.texels.assign(6, {200, 100, 50, 255});
  const auto triangles = *rc::gen::inRange(1U, 80U);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::dvec3 at = point(2);
    for (std::uint32_t k = 0; k < 3; ++k) {
      scene.positions.push_back(*rc::gen::arbitrary<bool>() ? at + point(1) : point(3));
      scene.normals.push_back(*rc::gen::arbitrary<bool>() ? point(1) : glm::dvec3(0.0));
      scene.uvs.emplace_back(number(-2, 2), number(-2, 2));
    }
    scene.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, *rc::gen::inRange(0U, 4U), i});
  }
  for (auto lights = *rc::gen::inRange(0, 4); lights > 0; --lights) {
    scenes::Light& light = scene.lights.emplace_back();
    light.kind =
        *rc::gen::element(scenes::LightKind::point, scenes::LightKind::directional, scenes::LightKind::spot);
    light.position = point(5);
    light.inverse_square = *rc::gen::arbitrary<bool>();
    light.range = *rc::gen::element(0.0, 4.0);
  }
  return scene;
}

RC_GTEST_PROP(Render, AnySceneGivesFiniteColoursThatNoStructureChanges, ()) {
  const scenes::Scene scene = random_scene();
  const RenderOptions options{.width = 12,
                              .height = 12,
                              .max_depth = *rc::gen::inRange(1U, 7U),
                              .min_weight = *rc::gen::element(0.0, 0.1),
                              .shadows = *rc::gen::arbitrary<bool>(),
                              .record = true};
  const Frame brute = Built(scene, "none").render(options);
  for (const glm::vec3& pixel : brute.image.pixels) {
    RC_ASSERT(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
    RC_ASSERT(pixel.x >= 0.0F && pixel.y >= 0.0F && pixel.z >= 0.0F);
  }
  for (const std::string_view kind : accel::structure_kinds()) {
    const Frame frame = Built(scene, kind).render(options);
    RC_ASSERT(same_bytes(brute.image, frame.image));
    RC_ASSERT(brute.hit_hash == frame.hit_hash);
    RC_ASSERT(brute.rays.traced == frame.rays.traced);
    RC_ASSERT(brute.rays.hit == frame.rays.hit);
    RC_ASSERT(program::fault_of(*frame.log) == "");
    RC_ASSERT(totals_of(*frame.log).all_rays() == frame.rays.all());
  }
}

TEST(Render, RefusesOptionsOutOfRange) {
  const Built built(scenes::make_procedural("tetra:1"));
  const auto refused = [&](const RenderOptions& options) {
    EXPECT_THROW(static_cast<void>(built.render(options)), sim::UserError);
  };
  refused({.width = 0});
  refused({.height = 0});
  refused({.width = 40000});
  refused({.max_depth = 0});
  refused({.max_depth = 65});
  refused({.min_weight = -0.1});
  refused({.min_weight = 1.5});
  refused({.min_weight = std::numeric_limits<double>::quiet_NaN()});
  refused({.samples = 0});
  refused({.samples = 1025});
}

TEST(Render, AnEmptySceneIsAllBackground) {
  scenes::Scene scene = test::looking_down(1.0);
  scene.background = {0.25, 0.5, 0.75};
  for (const std::string_view kind : accel::structure_kinds()) {
    const Frame frame = Built(scene, kind).render({.width = 3, .height = 2, .record = true});
    for (const glm::vec3& pixel : frame.image.pixels) {
      EXPECT_EQ(pixel, glm::vec3(0.25F, 0.5F, 0.75F));
    }
    EXPECT_EQ(program::fault_of(*frame.log), "");
  }
}

// Mailboxes keep image and rays, and leave out exactly the tests that repeat one of the same ray.
TEST(Render, MailboxesLeaveOutWhatTheRayHasTested) {
  for (const std::string_view kind : {"octree", "bsp", "grid", "bvh", "none"}) {
    const test::Built built(scenes::make_procedural("gears:1"), kind);
    RenderOptions options{.width = 40, .height = 40, .max_depth = 3, .record = true};
    const Frame without = built.render(options);
    options.mailboxes = true;
    const Frame with = built.render(options, 3);
    EXPECT_EQ(with.hit_hash, without.hit_hash) << kind;
    EXPECT_EQ(with.image.pixels, without.image.pixels) << kind;
    EXPECT_FALSE(without.log->mailboxes);
    ASSERT_TRUE(with.log->mailboxes);
    ASSERT_EQ(program::fault_of(*with.log), "");
    options.record = false;
    EXPECT_EQ(built.render(options).hit_hash, without.hit_hash) << kind;

    const WorkLog& log = *with.log;
    std::uint64_t lookups = 0;
    for (const LogRow& row : log.rows) {
      std::set<std::uint32_t> tested;
      for (std::size_t at = 0; at < row.words.size(); at += step_words(row.words.data() + at)) {
        const std::uint32_t* const word = row.words.data() + at;
        const Step step = step_of(*word);
        if (step == Step::ray) {
          tested.clear();
        }
        if (step != Step::leaf && step != Step::partial_leaf && step != Step::mailed_leaf) {
          continue;
        }
        const accel::TopologyNode& leaf = log.topology.nodes[operand_of(*word)];
        const std::uint32_t read = step == Step::leaf ? leaf.count : word[1];
        lookups += read;
        for (std::uint32_t k = 0; k < read; ++k) {
          const bool is_tested = step != Step::mailed_leaf || ((word[2 + k / 32] >> (k % 32)) & 1U) != 0;
          ASSERT_EQ(tested.insert(log.topology.entries[leaf.first + k]).second, is_tested) << kind;
        }
      }
    }
    const LogTotals totals = totals_of(log);
    const LogTotals all = totals_of(*without.log);
    EXPECT_EQ(totals.lookups, lookups);
    EXPECT_EQ(totals.lookups, all.tests);
    EXPECT_EQ(all.lookups, 0U);
    EXPECT_EQ(totals.leaves, all.leaves);
    EXPECT_EQ(totals.branches, all.branches);
    if (kind == "none" || kind == "bvh") {  // they list no primitive twice
      EXPECT_EQ(totals.tests, all.tests);
    } else {
      EXPECT_LT(totals.tests, all.tests);
    }
  }
}

}  // namespace
}  // namespace marti::processors
