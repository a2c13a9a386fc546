// The proof of the plan: with and without each item the same image, the same hits, the same work log; and
// data that is left out is never read.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <string>
#include <vector>

#include "processors/program/shading.h"
#include "scenes/procedural.h"
#include "scenes/spd.h"
#include "studies/host/image_file.h"
#include "studies/run/plan/make_plan.h"
#include "studies/show/verify_plan.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/scenes/gltf_file.h"
#include "tests/unit/studies/plan_scenes.h"

namespace marti::studies {

using namespace host;
using namespace keys;
using namespace run;
using show::difference_of;

namespace {

using testing::Random;

void expect_same(const FunctionalRun& planned, const FunctionalRun& kept, const std::string& what) {
  ASSERT_EQ(planned.image_hash, kept.image_hash) << what;
  ASSERT_EQ(planned.frame.hit_hash, kept.frame.hit_hash) << what;
  ASSERT_EQ(difference_of(*planned.frame.log, *kept.frame.log), "") << what;
}

std::vector<PlanItem> left_out_by(const Plan& plan) {
  std::vector<PlanItem> items;
  for (const PlanEntry& entry : plan.entries) {
    if (entry.decision == PlanDecision::left_out) {
      items.push_back(entry.item);
    }
  }
  return items;
}

FunctionalRun run_keeping(FrameConfig frame, const KeptItems& keep, const scenes::Scene& scene) {
  frame.keep = keep;
  return testing::run_planned(frame, scene);
}

// Fills the data that the plan leaves out with values that would change the image if they were read.
scenes::Scene poisoned(const scenes::Scene& scene, const Plan& plan, const SceneNeeds& needs) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  scenes::Scene poison = scene;
  for (std::size_t i = 0; i < poison.textures.size(); ++i) {
    if (!needs.textures[i]) {
      for (auto& texel : poison.textures[i].texels) {
        texel = {static_cast<std::uint8_t>(texel[0] ^ 0xa5U), 7, 99, 0};
      }
    }
  }
  if (is_left_out(plan, PlanItem::texture_coordinates)) {
    std::fill(poison.uvs.begin(), poison.uvs.end(), glm::dvec2(nan));
  }
  if (is_left_out(plan, PlanItem::normals)) {
    std::fill(poison.normals.begin(), poison.normals.end(), glm::dvec3(nan));
  }
  for (std::size_t i = 0; i < poison.materials.size(); ++i) {
    if (!needs.materials[i]) {
      poison.materials[i].color = poison.materials[i].emission = glm::dvec3(nan);
    }
  }
  return poison;
}

// A log touches only what the plan keeps.
void expect_sound(const FunctionalRun& kept, const SceneNeeds& needs, const scenes::Scene& scene,
                  const std::string& what) {
  const processors::program::WorkLog& log = *kept.frame.log;
  for (const processors::program::LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size(); at += processors::program::step_words(&row.words[at])) {
      const std::uint32_t operand = processors::program::operand_of(row.words[at]);
      const processors::program::Step step = processors::program::step_of(row.words[at]);
      if (step == processors::program::Step::shade) {
        ASSERT_TRUE(needs.materials[operand]) << what;
      } else if (step == processors::program::Step::texel) {
        ASSERT_TRUE(needs.coordinates) << what;
      }
    }
  }
  ASSERT_TRUE(needs.reflection_rays || kept.frame.rays.traced[2] == 0) << what;
  ASSERT_TRUE(needs.refraction_rays || kept.frame.rays.traced[3] == 0) << what;
  ASSERT_TRUE(needs.diffuse_rays || kept.frame.rays.traced[4] == 0) << what;
  const bool any =
      std::any_of(scene.materials.begin(), scene.materials.end(), processors::program::asks_lights);
  ASSERT_TRUE(any || kept.frame.rays.traced[1] == 0) << what;
}

struct Tally {
  std::array<std::uint64_t, plan_items> left_out{};
};

void prove(const FrameConfig& frame, const scenes::Scene& scene, const std::string& what, Tally& tally) {
  const SceneNeeds needs = needs_of(scene, frame.render);
  const FunctionalRun planned = run_keeping(frame, {}, scene);
  ASSERT_NO_FATAL_FAILURE(
      expect_same(planned, run_keeping(frame, KeptItems::all_but_shadow_rays(), scene), what + ", all kept"));
  const FunctionalRun all = run_keeping(frame, KeptItems::all(), scene);
  ASSERT_EQ(planned.image_hash, all.image_hash) << what << ", with shadow rays that show nothing";
  ASSERT_GE(all.frame.rays.all(), planned.frame.rays.all()) << what;
  ASSERT_NO_FATAL_FAILURE(expect_sound(all, needs, scene, what));
  for (const PlanItem item : left_out_by(planned.plan)) {
    ++tally.left_out[static_cast<std::size_t>(item)];
  }
  const FunctionalRun poison = run_keeping(frame, KeptItems::all(), poisoned(scene, planned.plan, needs));
  ASSERT_EQ(poison.image_hash, all.image_hash) << what << ", poisoned";
  ASSERT_EQ(poison.frame.hit_hash, all.frame.hit_hash) << what << ", poisoned";
  ASSERT_EQ(difference_of(*poison.frame.log, *all.frame.log), "") << what << ", poisoned";
}

class PlanOfRandomScenes : public ::testing::TestWithParam<const char*> {};

// 4 x 300 scenes.
TEST_P(PlanOfRandomScenes, ChangesNothing) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::string structure = GetParam();
    Random random(1000 * structure.size() + seed);
    const scenes::Scene scene = testing::random_scene(random);
    const FrameConfig frame = testing::random_frame(random, structure);
    ASSERT_NO_FATAL_FAILURE(prove(frame, scene, structure + " " + std::to_string(seed), tally));
  }
  // The scenes cover the cases that they are made for.
  for (const PlanItem item : {PlanItem::shadow_rays, PlanItem::reflection_rays, PlanItem::refraction_rays,
                              PlanItem::textures, PlanItem::texture_coordinates, PlanItem::normals}) {
    EXPECT_GT(tally.left_out[static_cast<std::size_t>(item)], 15U) << name_of(item);
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, PlanOfRandomScenes,
                         ::testing::Values("octree", "bsp", "grid", "bvh", "none"));

class PlanOfShippedScenes : public ::testing::TestWithParam<std::string> {};

TEST_P(PlanOfShippedScenes, ChangesNothing) {
  FrameConfig frame = testing::small_frame("octree", 16);
  frame.structure_options.octree.max_objects = 8;
  frame.structure_options.octree.max_level = 6;
  frame.structure_options.bsp.max_objects = 8;
  frame.structure_options.bsp.max_level = 6;
  scenes::OpenOptions open;
  const scenes::Scene scene = scenes::open_scene(GetParam(), open, decode_image);
  Tally tally;
  prove(frame, scene, GetParam(), tally);
}

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const scenes::ProceduralScene& scene : scenes::procedural_scenes()) {
    const std::string name = std::string(scene.name) + ":" + std::to_string(scene.minimum_size);
    names.push_back(name);
    for (const scenes::ProceduralVariant& variant : scene.variants) {
      names.push_back(name + ":" + std::string(variant.name));
    }
  }
  names.emplace_back(MARTI_SOURCE "/configs/scenes/swing.glb");
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, PlanOfShippedScenes, ::testing::ValuesIn(shipped_scenes()),
                         [](const ::testing::TestParamInfo<std::string>& info) {
                           std::string name = info.param.substr(info.param.find_last_of('/') + 1);
                           std::replace_if(
                               name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; },
                               '_');
                           return name;
                         });

// A file with two textured squares, one before and one behind the camera, the latter with an image whose
// pixels are broken.
TEST(PlanOfFiles, DecodesWhatIsSeen) {
  using scenes::testing::GltfFile;
  scenes::Texture picture;
  picture.width = 16;
  picture.height = 16;
  picture.texels.assign(256, {200, 100, 50, 255});
  for (std::size_t i = 0; i < 256; i += 3) {
    picture.texels[i] = {static_cast<std::uint8_t>(i), 7, 9, 255};
  }
  const std::vector<std::byte> whole = encode_png(picture);
  // Not cut short: OpenImageIO 2.4 loses the memory of its message about a PNG file that ends early.
  std::vector<std::byte> broken = whole;
  broken[broken.size() / 2] ^= std::byte{0xff};
  GltfFile file = GltfFile::square();
  const int uvs = file.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 2);
  file.json["images"] = {{{"bufferView", file.add_view(whole)}, {"mimeType", "image/png"}},
                         {{"bufferView", file.add_view(broken)}, {"mimeType", "image/png"}}};
  file.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  for (int i = 0; i < 2; ++i) {
    file.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  }
  file.primitive()["material"] = 0;
  file.primitive()["attributes"]["TEXCOORD_0"] = uvs;
  nlohmann::json behind = file.json["meshes"][0];
  behind["primitives"][0]["material"] = 1;
  file.json["meshes"].push_back(behind);
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  file.json["nodes"] = {{{"mesh", 0}, {"translation", {-0.5, -0.5, -2.0}}},
                        {{"mesh", 1}, {"translation", {-0.5, -0.5, 2.0}}},
                        {{"camera", 0}}};
  file.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const test::TemporaryDirectory directory;
  FrameConfig frame = testing::small_frame("octree", 16);
  frame.scene = file.write_glb(directory.path(), "two.glb").string();

  const FunctionalRun run = run_functional(frame);
  Plan plan = run.plan;
  const PlanEntry& textures = *testing::find_entry(plan, PlanItem::textures);
  EXPECT_EQ(textures.decision, PlanDecision::left_out);
  EXPECT_EQ(textures.fact, "1 of 2 textures may colour a point that a ray meets");
  EXPECT_GT(run.totals.texels, 0U);
  // The simulated database has room for both.
  EXPECT_EQ(run.frame.log->texture_begin, (std::vector<std::uint64_t>{0, 256, 512}));
  // Kept, the image is decoded, and found to be broken: in its place and size it is white.
  frame.keep.keep(PlanItem::textures);
  frame.open.file.size_first = size_of_image;
  const FunctionalRun white = run_functional(frame);
  EXPECT_EQ(white.image_hash, run.image_hash);
  EXPECT_EQ(difference_of(*run.frame.log, *white.frame.log), "");
  EXPECT_EQ(std::ranges::count(white.notes,
                               "Replaced: 1 textures that cannot be decoded, by white ones of their size."),
            1);
  frame.open.file.strict = true;
  EXPECT_NE(test::user_error_of([&] { static_cast<void>(run_functional(frame)); }).find("cannot be decoded"),
            std::string::npos);
  // With a whole image there, nothing else differs. It is another one: equal images are one texture.
  picture.texels[0] = {1, 2, 3, 255};
  file.json["images"][1] = {{"bufferView", file.add_view(encode_png(picture))}, {"mimeType", "image/png"}};
  frame.scene = file.write_glb(directory.path(), "two.glb").string();
  const FunctionalRun kept = run_functional(frame);
  EXPECT_EQ(kept.image_hash, run.image_hash);
  EXPECT_EQ(difference_of(*run.frame.log, *kept.frame.log), "");
}

// The depth of rays decides from which level on voxels are small, also where no ray is sent on.
TEST(PlanProof, OfVoxelCuts) {
  const scenes::Scene scene = scenes::spd::make_tetra(5);
  FrameConfig frame = testing::small_frame("octree", 48);
  frame.render.max_depth = 4;
  frame.render.voxel_cut = 4.0;
  const FunctionalRun planned = run_keeping(frame, {}, scene);
  EXPECT_TRUE(is_left_out(planned.plan, PlanItem::reflection_rays));
  const FunctionalRun kept = run_keeping(frame, KeptItems::all(), scene);
  EXPECT_EQ(difference_of(*planned.frame.log, *kept.frame.log), "");
  frame.render.max_depth = 1;
  EXPECT_NE(difference_of(*planned.frame.log, *run_keeping(frame, {}, scene).frame.log), "")
      << "depth matters here";
}

// The proof can fail: it notices one changed word, texel or pixel.
TEST(PlanProof, SeesWhatDiffers) {
  Random random(5);
  scenes::Scene scene = testing::looking_ahead();
  testing::add_wall(scene, -3.0, testing::add_material(scene));
  testing::add_light(scene, {0.0, 1.0, 0.0});
  const FunctionalRun run = testing::run_planned(testing::small_frame(), scene);
  processors::program::WorkLog other = *run.frame.log;
  EXPECT_EQ(difference_of(*run.frame.log, other), "");
  other.rows[3].words.back() ^= 1U;
  EXPECT_EQ(difference_of(*run.frame.log, other), "row 3 of the work logs");
  other = *run.frame.log;
  other.texture_begin.push_back(1);
  EXPECT_EQ(difference_of(*run.frame.log, other), "the databases of the work logs");
  other = *run.frame.log;
  other.topology.entries.push_back(0);
  EXPECT_EQ(difference_of(*run.frame.log, other), "the trees of the work logs");
}

}  // namespace
}  // namespace marti::studies
