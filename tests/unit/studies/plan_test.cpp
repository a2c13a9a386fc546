// What the plan decides, and above all what it must not leave out.
#include "studies/run/plan/make_plan.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "studies/run/plan/view.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/plan_scenes.h"

namespace marti::studies {

using namespace keys;
using namespace run;

namespace {

using testing::add_checker;
using testing::add_light;
using testing::add_material;
using testing::add_triangle;
using testing::add_wall;
using testing::looking_ahead;
using testing::Random;
using testing::small_frame;

Plan plan_of(const scenes::Scene& scene, const processors::program::RenderOptions& render,
             const KeptItems& keep = {}) {
  return make_plan(facts_of_frame(scene, render, keep));
}

PlanDecision decision(const scenes::Scene& scene, PlanItem item, const KeptItems& keep = {}) {
  Plan plan = plan_of(scene, small_frame().render, keep);
  return testing::find_entry(plan, item)->decision;
}

TEST(Plan, NamesOfItemsToKeep) {
  const std::vector<std::string> some = {"normals", "textures", "normals"};
  const KeptItems kept{some};
  EXPECT_TRUE(kept.has(PlanItem::normals) && kept.has(PlanItem::textures));
  EXPECT_FALSE(kept.has(PlanItem::cache));
  const std::vector<std::string> all = {"all"};
  for (std::size_t i = 0; i < plan_items; ++i) {
    EXPECT_TRUE(KeptItems{all}.has(static_cast<PlanItem>(i)));
  }
  const std::vector<std::string> wrong = {"normal"};
  const std::string message = test::user_error_of([&] { static_cast<void>(KeptItems{wrong}); });
  EXPECT_NE(message.find("--keep: the plan has no item \"normal\" (did you mean \"normals\"?)"),
            std::string::npos)
      << message;
}

TEST(Plan, EntriesAreInTheOrderOfItemsOnceEach) {
  scenes::Scene scene = looking_ahead();
  add_wall(scene, -3.0, add_material(scene));
  PlanEntry cache;
  cache.item = PlanItem::cache;
  PlanEntry contention;
  contention.item = PlanItem::contention;
  const Plan plan = make_plan(facts_of_frame(scene, small_frame().render, {}), {cache, contention});
  for (std::size_t i = 1; i < plan.entries.size(); ++i) {
    EXPECT_LT(plan.entries[i - 1].item, plan.entries[i].item);
  }
  EXPECT_EQ(plan.entries.back().item, PlanItem::cache);
}

// Work that is not needed is left out, and kept where the user asks for it.
TEST(Plan, LeavesOutWhatIsBehindTheCamera) {
  scenes::Scene scene = looking_ahead();
  const std::uint32_t plain = add_material(scene);
  const std::uint32_t textured = add_material(scene);
  scene.materials[textured].texture = add_checker(scene);
  scene.materials[textured].reflection = 0.5;
  add_wall(scene, -3.0, plain);
  add_wall(scene, 3.0, textured);
  scene.uvs.resize(scene.positions.size(), glm::dvec2(0.5));
  scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
  scene.normals[3] = {0.0, 1.0, 0.0};
  add_light(scene, {0.0, 5.0, 0.0});
  EXPECT_EQ(decision(scene, PlanItem::normals), PlanDecision::needed) << "the wall ahead is lit";
  scene.materials[plain].diffuse = 0.0;
  EXPECT_EQ(decision(scene, PlanItem::shadow_rays), PlanDecision::not_applicable);
  for (const PlanItem item : {PlanItem::textures, PlanItem::texture_coordinates, PlanItem::normals,
                              PlanItem::reflection_rays, PlanItem::refraction_rays}) {
    EXPECT_EQ(decision(scene, item), PlanDecision::left_out) << name_of(item);
    EXPECT_EQ(decision(scene, item, KeptItems::all()), PlanDecision::kept) << name_of(item);
  }
  Plan plan = plan_of(scene, small_frame().render);
  EXPECT_EQ(testing::find_entry(plan, PlanItem::reflection_rays)->fact,
            "none of the 1 materials that rays can reach are reflective; 1 that none can reach would be");
  EXPECT_EQ(planned_options(plan, facts_of_frame(scene, small_frame().render, {})).max_depth, 1U);
}

// A mirror or glass in view sends rays to primitives beside the view.
TEST(Plan, KeepsNormalsThatAreSeenInMirrorsAndThroughGlass) {
  for (double scenes::Material::*const way :
       {&scenes::Material::reflection, &scenes::Material::transmission}) {
    scenes::Scene scene = looking_ahead();
    const std::uint32_t wall = add_material(scene);
    scene.materials[wall].diffuse = 0.0;
    scene.materials[wall].ior = 1.5;
    add_wall(scene, -2.0, wall);
    // Just beside the left edge of the view.
    add_triangle(scene, {-12.0, -2.0, -10.9}, {-12.0, 2.0, -10.9}, {-19.0, 0.0, -10.0}, add_material(scene));
    scene.normals.resize(scene.positions.size(), glm::dvec3(0.0));
    scene.normals[3] = {0.6, 0.0, 0.8};
    add_light(scene, {0.0, 4.0, 0.0});
    EXPECT_EQ(decision(scene, PlanItem::normals), PlanDecision::left_out);
    scene.materials[wall].*way = 0.9;
    EXPECT_EQ(decision(scene, PlanItem::normals), PlanDecision::needed);
  }
}

TEST(Plan, BlackMaterialsSendNoShadowRays) {
  scenes::Scene scene = looking_ahead();
  const std::uint32_t black = add_material(scene);
  scene.materials[black].color = glm::dvec3(0.0);
  add_wall(scene, -5.0, black);
  add_light(scene, {0.0, 2.0, 0.0});
  const FunctionalRun without = testing::run_planned(small_frame(), scene);
  FrameConfig keep = small_frame();
  keep.keep.keep(PlanItem::shadow_rays);
  const FunctionalRun with = testing::run_planned(keep, scene);
  EXPECT_EQ(without.totals.rays[1], 0U);
  EXPECT_EQ(with.totals.rays[1], with.frame.rays.hit[0]);
  EXPECT_GT(with.totals.rays[1], 0U);
  EXPECT_EQ(with.image_hash, without.image_hash);
  Plan plan = without.plan;
  EXPECT_EQ(testing::find_entry(plan, PlanItem::shadow_rays)->decision, PlanDecision::left_out);
  // A highlight shows on black.
  scene.materials[black].highlight = 0.5;
  EXPECT_EQ(decision(scene, PlanItem::shadow_rays), PlanDecision::needed);
}

TEST(Plan, MailboxesHaveNoEffectWhereNothingIsListedTwice) {
  scenes::Scene scene = looking_ahead();
  const std::uint32_t material = add_material(scene);
  add_triangle(scene, {-1.0, -1.0, -4.0}, {1.0, -1.0, -4.0}, {0.0, 1.0, -4.0}, material);
  FrameConfig frame = small_frame("none");
  frame.render.mailboxes = true;
  Plan plan = testing::run_planned(frame, scene).plan;
  EXPECT_EQ(testing::find_entry(plan, PlanItem::mailboxes)->decision, PlanDecision::left_out);
  frame.structure = "octree";
  Random random(7);
  for (int i = 0; i < 30; ++i) {
    const glm::dvec3 a = random.point(3.0);
    const glm::dvec3 b = random.point(3.0);
    add_triangle(scene, a, b, random.point(3.0), material);
  }
  plan = testing::run_planned(frame, scene).plan;
  EXPECT_EQ(testing::find_entry(plan, PlanItem::mailboxes)->decision, PlanDecision::needed);
}

// Whatever is added to a scene may only enlarge what is kept.
TEST(Plan, MoreOfASceneNeedsMore) {
  const auto is_part = [](const std::vector<bool>& part, const std::vector<bool>& whole) {
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (part[i] && !whole[i]) {
        return false;
      }
    }
    return true;
  };
  const auto check = [&](const SceneNeeds& before, const SceneNeeds& after, const char* what) {
    EXPECT_TRUE(is_part(before.materials, after.materials)) << what;
    EXPECT_TRUE(is_part(before.textures, after.textures)) << what;
    EXPECT_LE(before.coordinates, after.coordinates) << what;
    EXPECT_LE(before.normals, after.normals) << what;
    EXPECT_LE(before.shadow_rays, after.shadow_rays) << what;
    EXPECT_LE(before.reflection_rays, after.reflection_rays) << what;
    EXPECT_LE(before.refraction_rays, after.refraction_rays) << what;
  };
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Random random(seed);
    const scenes::Scene scene = testing::random_scene(random);
    const processors::program::RenderOptions render = testing::random_frame(random, "octree").render;
    const SceneNeeds before = needs_of(scene, render);
    scenes::Scene more = scene;
    add_light(more, {1.0, 2.0, 3.0});
    check(before, needs_of(more, render), "a light");
    more = scene;
    scenes::Material& material =
        more.materials[random.below(static_cast<std::uint32_t>(more.materials.size()))];
    material.color = glm::dvec3(1.0);
    material.specular_color = glm::dvec3(1.0);
    material.diffuse += 0.1;
    material.reflection += random.chance(0.5) ? 0.1 : 0.0;
    material.transmission += random.chance(0.5) ? 0.1 : 0.0;
    material.highlight += 0.1;
    check(before, needs_of(more, render), "a material that does more");
    more = scene;
    add_wall(more, random.chance(0.5) ? -2.0 : 2.0, 0);
    more.uvs.resize(scene.uvs.empty() ? 0 : more.positions.size());
    more.normals.resize(scene.normals.empty() ? 0 : more.positions.size(), glm::dvec3(0.0));
    check(before, needs_of(more, render), "a triangle");
  }
}

// Every triangle that a ray of the camera hits may be met; and many others may not.
TEST(View, HoldsAllThatARayMeets) {
  std::uint64_t met = 0;
  std::uint64_t beside = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    scenes::Scene scene = looking_ahead();
    const double offset = random.chance(0.3) ? 1e7 : 0.0;
    scene.camera.eye = glm::dvec3(offset);
    scene.camera.at = scene.camera.eye + random.point(1.0);
    scene.camera.up = {0.1, 1.0, 0.3};
    scene.camera.vertical_fov = random.chance(0.3) ? 2.9 : random.between(0.001, 1.5);
    add_material(scene);
    const double reach = random.chance(0.5) ? 5.0 : 0.01;
    for (int i = 0; i < 20; ++i) {
      const glm::dvec3 center = scene.camera.eye + random.point(reach);
      const glm::dvec3 a = center + random.point(0.4 * reach);
      const glm::dvec3 b = center + random.point(0.4 * reach);
      add_triangle(scene, a, b, center + random.point(0.4 * reach), 0);
    }
    const scenes::ImagePlane plane = scene.camera.image_plane(16, 8);
    const bool several = random.chance(0.5);
    const View view(plane, 16, 8, several);
    for (std::uint32_t id = 0; id < 20; ++id) {
      scenes::Scene one = scene;
      one.triangles = {scene.triangles[id]};
      const accel::TriangleSet set(one);
      const auto structure = accel::make_structure("none", std::make_shared<const accel::TriangleSet>(set));
      bool hit = false;
      for (std::uint32_t pixel = 0; pixel < 128; ++pixel) {
        const double x = several ? 0.5 * (pixel % 3) : 0.5;
        const double y = several ? 0.5 * (pixel % 5 / 2) : 0.5;
        const glm::dvec3 direction =
            plane.corner + plane.step_x * (pixel % 16 + x) + plane.step_y * (pixel / 16 + y);
        hit = hit || structure
                         ->closest({{plane.origin.x, plane.origin.y, plane.origin.z},
                                    {direction.x, direction.y, direction.z}})
                         .found();
      }
      const bool may = view.may_meet(scene, id);
      EXPECT_TRUE(may || !hit) << seed << ' ' << id;
      met += hit ? 1U : 0U;
      beside += may ? 0U : 1U;
    }
  }
  EXPECT_GT(met, 500U);
  EXPECT_GT(beside, 1000U);
}

}  // namespace
}  // namespace marti::studies
