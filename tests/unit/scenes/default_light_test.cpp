// Which scenes get a light that is not in them, and views that are not in them.
#include <string>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "processors/program/path_sampling.h"
#include "scenes/gltf_export.h"
#include "scenes/part_error.h"
#include "scenes/procedural.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::has_note;

constexpr std::array modes = {DefaultLight::automatic, DefaultLight::always, DefaultLight::never};

/// A square that shines or not, without or with a light, as glTF or OBJ, which has no lights.
std::string square(bool shines, bool lit, bool obj) {
  if (obj) {
    return "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  }
  testing::GltfFile file = testing::GltfFile::square();
  file.json["materials"] = {{{"emissiveFactor", {shines ? 1 : 0, 0, 0}}}};
  file.primitive()["material"] = 0;
  if (lit) {
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  }
  return file.glb();
}

// Whether surfaces light others is the renderer's word, not the reader's.
TEST(DefaultLight, OnlyWhatIsDarkOtherwiseUnlessTheKeySaysSo) {
  const testing::SceneFolder folder;
  for (const bool obj : {false, true}) {
    for (const bool shines : {false, true}) {
      for (const bool lit : {false, true}) {
        for (const bool path : {false, true}) {
          for (const DefaultLight mode : modes) {
            folder.write("a.mtl", std::string("newmtl m\nKe ") + (shines ? "1" : "0") + " 0 0\n");
            FileOptions options;
            options.default_light = mode;
            options.emitters_light = path;
            const Scene scene = folder.open(obj ? "a.obj" : "a.glb", square(shines, lit, obj), options);
            const std::size_t own = lit && !obj ? 1 : 0;
            const bool dark = own == 0 && !(path && !processors::program::Emitters(scene).empty());
            const bool added = mode == DefaultLight::always || (mode == DefaultLight::automatic && dark);
            EXPECT_EQ(scene.lights.size(), own + (added ? 1U : 0U));
            EXPECT_EQ(scene.ambient, glm::dvec3(added ? 0.2 : 0.0));
            EXPECT_EQ(has_note(scene, "over the camera's shoulder"), added);
            EXPECT_EQ(has_note(scene, "no ray looks for a light"),
                      dark && path && mode == DefaultLight::never);
          }
        }
      }
    }
  }
}

TEST(DefaultLight, RecipesHaveAllTheirLights) {
  const testing::SceneFolder folder;
  const auto path = folder.write("room.glb", "");
  export_glb(make_procedural("room:2"), path);
  for (const std::string& spec : {std::string("room:2"), path.string()}) {
    for (const DefaultLight mode : modes) {
      OpenOptions options;
      options.file.default_light = mode;
      EXPECT_EQ(open_scene(spec, options, {}).lights.size(), mode == DefaultLight::always ? 1U : 0U) << spec;
    }
  }
}

// The added light stays where it is while the file's own move.
TEST(DefaultLight, IsInEveryPose) {
  const testing::SceneFolder folder;
  testing::GltfFile file = testing::GltfFile::square();
  const int times = file.add_accessor(std::vector<float>{0, 1}, 5126, "SCALAR", 1);
  const int moves = file.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0}, 5126, "VEC3", 3);
  file.json["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", moves}}}}}};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  FileOptions options;
  options.default_light = DefaultLight::always;
  const Scene first = folder.open("a.glb", file.glb(), options);
  options.time = 1.0;
  const Scene last = folder.open("a.glb", file.glb(), options);
  ASSERT_EQ(first.lights.size(), 2U);
  ASSERT_EQ(last.lights.size(), 2U);
  EXPECT_NE(first.lights[0].position, last.lights[0].position);
  EXPECT_EQ(first.lights[1].direction, last.lights[1].direction);
}

// In every kind of scene and in each pose, in place of its background and beside its lights.
TEST(Sky, AndSunAreInEveryKindOfSceneAndPose) {
  const testing::SceneFolder folder;
  testing::GltfFile moving = testing::GltfFile::square();
  const int times = moving.add_accessor(std::vector<float>{0, 1}, 5126, "SCALAR", 1);
  const int moves = moving.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0}, 5126, "VEC3", 3);
  moving.json["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", moves}}}}}};
  const auto dark = folder.write("dark.glb", moving.glb());
  moving.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  moving.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  const auto lit = folder.write("lit.glb", moving.glb());
  const auto obj = folder.write("a.obj", square(false, false, true));
  folder.write("a.mtl", "newmtl m\n");
  const glm::dvec3 sky(0.25, 0.5, 1.0);
  for (const std::string& spec : {std::string("tetra:2"), dark.string(), lit.string(), obj.string()}) {
    for (const double time : {0.0, 1.0}) {
      OpenOptions options;
      options.file.default_light = DefaultLight::never;
      options.file.time = spec.ends_with(".glb") ? time : 0.0;
      const Scene own = open_scene(spec, options, {});
      options.file.default_light = DefaultLight::automatic;
      options.file.sky = {sky, glm::dvec3(0.0, 3e-200, 4e-200), glm::dvec3(2.0)};
      const Scene scene = open_scene(spec, options, {});
      EXPECT_EQ(scene.background, sky) << spec;
      EXPECT_EQ(scene.ambient, sky) << spec;
      ASSERT_EQ(scene.lights.size(), own.lights.size() + 1) << spec;
      for (std::size_t i = 0; i < own.lights.size(); ++i) {
        EXPECT_EQ(scene.lights[i].position, own.lights[i].position) << spec;
      }
      EXPECT_EQ(scene.lights.back().kind, LightKind::directional);
      EXPECT_LT(glm::length(scene.lights.back().direction - glm::dvec3(0.0, -0.6, -0.8)), 1e-15);
      EXPECT_EQ(scene.lights.back().color, glm::dvec3(2.0));
      EXPECT_FALSE(has_note(scene, "over the camera's shoulder")) << spec;
      // Without a sun, a sky lights paths alone: it is no emitter, to which shadow rays could go.
      for (const bool path : {false, true}) {
        options.file.sky = {sky, {}, {}};
        options.file.emitters_light = true;
        options.file.sky_lights = path;
        const bool added = own.lights.empty() && !own.lights_are_all && !path;
        EXPECT_EQ(open_scene(spec, options, {}).lights.size(), own.lights.size() + (added ? 1U : 0U)) << spec;
      }
    }
  }
}

// In every kind of scene and in each pose. A member of the view that is not given is that of the scene's
// camera.
TEST(View, ReplacesTheCameraOfEveryKindOfScene) {
  const testing::SceneFolder folder;
  testing::GltfFile moving = testing::GltfFile::square();
  const int times = moving.add_accessor(std::vector<float>{0, 1}, 5126, "SCALAR", 1);
  const int moves = moving.add_accessor(std::vector<float>{0, 0, 5, 1, 0, 9}, 5126, "VEC3", 3);
  moving.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  moving.json["nodes"].push_back({{"camera", 0}});
  moving.json["scenes"][0]["nodes"].push_back(moving.json["nodes"].size() - 1);
  moving.json["animations"] = {
      {{"channels",
        {{{"sampler", 0}, {"target", {{"node", moving.json["nodes"].size() - 1}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", moves}}}}}};
  const auto glb = folder.write("moving.glb", moving.glb());
  const auto obj = folder.write("a.obj", square(false, false, true));
  folder.write("a.mtl", "newmtl m\n");
  const auto still = folder.write("teapot.glb", "");
  export_glb(make_procedural("tetra:2"), still);
  for (const std::string& spec : {std::string("tetra:2"), still.string(), glb.string(), obj.string()}) {
    for (const double time : {0.0, 1.0}) {
      OpenOptions options;
      options.file.time = spec == glb.string() ? time : 0.0;
      const Camera own = open_scene(spec, options, {}).camera;
      options.file.view = {glm::dvec3(1.0, 2.0, 3.0), {}, {}, 0.25};
      const Scene part = open_scene(spec, options, {});
      EXPECT_EQ(part.camera.eye, glm::dvec3(1.0, 2.0, 3.0)) << spec;
      EXPECT_EQ(part.camera.at, own.at) << spec;
      EXPECT_EQ(part.camera.up, own.up) << spec;
      EXPECT_EQ(part.camera.vertical_fov, 0.25) << spec;
      EXPECT_FALSE(has_note(part, "no perspective camera")) << spec;
      options.file.view.look_at = glm::dvec3(4.0, 2.0, 3.0);
      options.file.view.up = glm::dvec3(0.0, 0.0, 1.0);
      const Scene whole = open_scene(spec, options, {});
      EXPECT_EQ(whole.camera.at, glm::dvec3(4.0, 2.0, 3.0)) << spec;
      EXPECT_EQ(whole.camera.up, glm::dvec3(0.0, 0.0, 1.0)) << spec;
      options.file.view.up = glm::dvec3(-2.0, 0.0, 0.0);
      try {
        (void)open_scene(spec, options, {});
        ADD_FAILURE() << spec << ": up lies along the line of sight";
      } catch (const PartError& error) {
        EXPECT_EQ(error.part(), "look_at");
      }
    }
  }
}

// A narrower view of a file without a camera is seen from further away.
TEST(View, OfAFileWithoutACameraHoldsAllOfIt) {
  const testing::SceneFolder folder;
  const auto obj = folder.write("a.obj", square(false, false, true));
  folder.write("a.mtl", "newmtl m\n");
  for (const double fov : {0.01, 0.2, 0.7854, 2.5}) {
    OpenOptions options;
    options.file.view.vertical_fov = fov;
    const Scene scene = open_scene(obj.string(), options, {});
    const glm::dvec3 sight = glm::normalize(scene.camera.at - scene.camera.eye);
    for (const glm::dvec3& position : scene.positions) {
      EXPECT_GT(glm::dot(glm::normalize(position - scene.camera.eye), sight), std::cos(fov / 2.0)) << fov;
    }
  }
}

// The default light comes over the shoulder of who looks.
TEST(View, TurnsTheDefaultLight) {
  OpenOptions options;
  options.file.default_light = DefaultLight::always;
  const Scene own = open_scene("tetra:2", options, {});
  options.file.view.eye = own.camera.at + (own.camera.at - own.camera.eye);
  const Scene behind = open_scene("tetra:2", options, {});
  const auto along = [](const Scene& scene) {
    return glm::dot(scene.lights.back().direction, scene.camera.at - scene.camera.eye);
  };
  EXPECT_GT(along(own), 0.0);
  EXPECT_DOUBLE_EQ(along(own), along(behind));
}

}  // namespace
}  // namespace marti::scenes
