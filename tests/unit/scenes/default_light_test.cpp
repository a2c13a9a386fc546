// Which scenes get a light that is not in them.
#include <string>

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "loaded_scene.h"
#include "processors/program/path_sampling.h"
#include "scenes/gltf_export.h"
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

}  // namespace
}  // namespace marti::scenes
