// Frames of triangles with holes: every structure and program finds what each triangle by itself would give,
// and the log has each hit that was asked about, behind its leaf.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "processors/program/log_rules.h"
#include "program_scenes.h"
#include "scenes/procedural.h"
#include "tests/support/holed_scene.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

scenes::Scene holed_teapot() {
  scenes::Scene scene = marti::test::holed(scenes::make_procedural("teapot:2"));
  scene.materials[scene.materials.size() - 3].emission = glm::dvec3(0.5);  // shines between its holes
  scene.materials[scene.materials.size() - 2].reflection = 0.4;
  return scene;
}

std::vector<Frame> all_frames(const scenes::Scene& scene, const RenderOptions& options) {
  std::vector<Frame> frames;
  for (const std::string_view kind : accel::structure_kinds()) {
    const Built built(scene, kind);
    frames.push_back(built.render(options));
    RenderOptions mailboxes = options;
    mailboxes.mailboxes = true;
    frames.push_back(built.render(mailboxes));
    if (kind == "bvh") {
      RenderOptions ordered = options;
      for (const auto order : {accel::WalkOrder::breadth_first, accel::WalkOrder::treelet_first}) {
        ordered.order = order;
        ordered.treelet_records = 6;
        frames.push_back(built.render(ordered));
      }
    }
  }
  return frames;
}

TEST(Holes, EveryStructureAndProgramSeesThroughThem) {
  const scenes::Scene scene = holed_teapot();
  scenes::Scene opaque = scene;
  for (scenes::Material& material : opaque.materials) {
    material.cut_out = {};
  }
  for (const Integrator integrator :
       {Integrator::whitted, Integrator::path, Integrator::shadow, Integrator::occlusion}) {
    RenderOptions options{.width = 48, .height = 40, .max_depth = 3, .integrator = integrator};
    options.record = true;
    const std::vector<Frame> frames = all_frames(scene, options);
    EXPECT_NE(frames.front().hit_hash, Built(opaque).render(options).hit_hash);
    for (const Frame& frame : frames) {
      EXPECT_EQ(frame.hit_hash, frames.front().hit_hash);
      EXPECT_TRUE(frame.image.pixels == frames.front().image.pixels);
      EXPECT_EQ(fault_of(*frame.log), "");
      EXPECT_GT(totals_of(*frame.log).any_hits, 400U);
    }
    RenderOptions plain = options;
    plain.record = false;
    EXPECT_EQ(Built(scene, "bvh").render(plain).hit_hash, frames.front().hit_hash);
    options.floats = true;
    const std::vector<Frame> floats = all_frames(scene, options);
    for (const Frame& frame : floats) {
      EXPECT_EQ(frame.hit_hash, floats.front().hit_hash);
    }
  }
}

TEST(Holes, AnOpaqueSceneIsNeverAsked) {
  scenes::Scene scene = holed_teapot();
  for (scenes::Texture& texture : scene.textures) {
    for (std::array<std::uint8_t, 4>& texel : texture.texels) {
      texel = {255, 255, 255, 255};
    }
  }
  const Built built(scene, "bvh");
  EXPECT_EQ(built.triangles->cut_outs(), nullptr);
  const Frame frame = built.render({.width = 8, .height = 8, .record = true});
  EXPECT_EQ(totals_of(*frame.log).any_hits, 0U);
  scene.uvs.clear();
  EXPECT_EQ(accel::TriangleSet(scene).cut_outs(), nullptr);
}

// Without a structure a ray asks about hits in the order of the triangles.
TEST(Holes, TheLogHasEachHitThatWasAskedAbout) {
  const scenes::Scene scene = holed_teapot();
  const RenderOptions options{.width = 24, .height = 24, .max_depth = 1, .shadows = false, .record = true};
  const Frame frame = Built(scene).render(options);
  marti::test::NaiveHoles naive(scene);
  const scenes::ImagePlane plane = image_plane(scene.camera, options);
  std::uint64_t hits = 0;
  for (std::uint32_t y = 0; y < options.height; ++y) {
    for (std::uint32_t x = 0; x < options.width; ++x) {
      const glm::dvec3 way = plane.corner + (x + 0.5) * plane.step_x + (y + 0.5) * plane.step_y;
      const std::uint64_t before = naive.asked;
      hits += naive.closest({plane.origin, glm::normalize(way)}).found() ? 1 : 0;
      const std::span<const std::uint32_t> words = frame.log->pixel(x, y);
      std::uint64_t asked = 0;
      for (std::size_t at = 0; at < words.size(); at += step_words(&words[at])) {
        if (step_of(words[at]) == Step::any_hit) {
          ASSERT_EQ(at, 2 + 3 * asked) << "behind the ray and its only leaf";
          ++asked;
          const std::uint32_t texture = scene.materials[operand_of(words[at])].cut_out.texture;
          EXPECT_EQ(words[at + 1], make_word(Step::texel, texture));
        }
      }
      EXPECT_EQ(asked, naive.asked - before) << x << " " << y;
    }
  }
  EXPECT_EQ(hits, frame.rays.hit[0]);
  EXPECT_EQ(totals_of(*frame.log).any_hits, naive.asked);
  EXPECT_GT(naive.asked, 100U);
}

// A panel of light with one texel cut out of four, asked point by point, gives three quarters of the light.
TEST(Holes, LightComesFromWhatIsNotCutOut) {
  const auto mean_light = [](bool holes) {
    scenes::Scene scene = test::looking_down(1.0);
    scene.camera.vertical_fov = 0.1;
    scene.materials.resize(2);
    scene.materials[1].emission = glm::dvec3(3.0);
    test::add_floor(scene, 0.0, 5.0, 0);
    test::add_ceiling(scene, 60.0, 1.0, 1);
    scene.uvs.assign(scene.positions.size(), glm::dvec2(0.0));
    const glm::dvec2 corners[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    std::copy_n(corners, 4, scene.uvs.end() - 4);
    scenes::Texture& texture = scene.textures.emplace_back();
    texture.width = texture.height = 2;
    texture.texels.assign(4, {255, 255, 255, 255});
    texture.texels[2][3] = holes ? 0 : 255;
    scene.materials[1].cut_out = {1.0, 0.5, 0};
    RenderOptions options{.width = 8, .height = 8, .max_depth = 1, .integrator = Integrator::path};
    options.samples = 64;
    double sum = 0.0;
    for (const glm::vec3& pixel : Built(scene, "bvh").render(options).image.pixels) {
      sum += static_cast<double>(pixel.x);
    }
    return sum;
  };
  const double whole = mean_light(false);
  EXPECT_GT(whole, 0.0);
  EXPECT_NEAR(mean_light(true) / whole, 0.75, 0.03);  // four deviations of 4,096 points
}

TEST(Holes, WhatCannotDealWithThemRefuses) {
  const Built octree(holed_teapot(), "octree");
  EXPECT_NE(marti::test::user_error_of([&] {
              (void)octree.render({.width = 4, .height = 4, .voxel_cut = 1.0});
            }).find("holes"),
            std::string::npos);
  const Built bvh(holed_teapot(), "bvh");
  EXPECT_NE(marti::test::user_error_of([&] {
              RenderOptions options{.width = 4, .height = 4, .record = true};
              options.meets = true;
              (void)bvh.render(options);
            }).find("rt.share"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::processors
