#include "studies/run/plan/make_plan.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "accel/bsp.h"
#include "accel/bvh.h"
#include "accel/traversal.h"

namespace marti::studies::run {

namespace {

constexpr std::int64_t normal_bytes = sizeof(glm::dvec3);
constexpr std::int64_t coordinate_bytes = sizeof(glm::dvec2);
constexpr std::int64_t texel_bytes = 4;
constexpr std::int64_t mailbox_bytes = sizeof(std::uint64_t);

std::string of(std::uint64_t part, std::uint64_t whole, std::string_view what) {
  std::string text = std::to_string(part) + " of " + std::to_string(whole) + " ";
  return text.append(what);
}

std::int64_t integer(std::uint64_t value) { return static_cast<std::int64_t>(value); }

// Whether an item exists and is needed, and the reason. Others are left out unless the user wants them kept.
struct Choice {
  bool exists = true;
  bool needed = false;
  std::string fact;
};

PlanEntry entry_of(PlanItem item, PlanClass kind, const KeptItems& keep, Choice choice, std::string unit,
                   const PlanCost& saved) {
  PlanEntry entry;
  entry.item = item;
  entry.kind = kind;
  entry.decision = !choice.exists   ? PlanDecision::not_applicable
                   : choice.needed  ? PlanDecision::needed
                   : keep.has(item) ? PlanDecision::kept
                                    : PlanDecision::left_out;
  entry.fact = std::move(choice.fact);
  entry.unit = std::move(unit);
  if (entry.decision == PlanDecision::left_out) {
    entry.saved = saved;
  }
  return entry;
}

PlanEntry shadow_rays(const PlanFacts& facts) {
  const SceneNeeds& needs = facts.needs;
  Choice choice;
  std::string lights = of(needs.shining_lights, needs.lights, "lights shine");
  if (!facts.render.shadows) {
    choice = {false, false, "image.shadows is false"};
  } else if (needs.shining_lights == 0) {
    choice = {false, false, std::move(lights)};
  } else if (needs.unlit == 0) {
    choice.needed = needs.shadow_rays;
    choice.exists = needs.shadow_rays;
    choice.fact = needs.shadow_rays ? lights + ", and every material that asks for them shows it"
                                    : "no material that a ray may meet asks for lights";
  } else {
    choice.fact = of(needs.unlit, needs.shaded, "materials that a ray may meet ask for lights and are black");
  }
  const auto pixels = std::uint64_t{facts.render.width} * facts.render.height * facts.render.samples;
  return entry_of(
      PlanItem::shadow_rays, needs.shadow_rays ? PlanClass::on_demand : PlanClass::proved, facts.keep,
      std::move(choice), "lights asked at points",
      {0, integer(pixels * needs.shining_lights * needs.unlit / std::max<std::uint64_t>(1, needs.shaded))});
}

PlanEntry spawned_rays(const PlanFacts& facts, PlanItem item, bool needed, std::uint64_t sending,
                       std::uint64_t beside, std::string_view verb, bool in_one_go) {
  Choice choice;
  if (facts.render.max_depth <= 1) {
    choice = {false, false, "image.max_depth is 1"};
  } else {
    choice.needed = needed;
    choice.fact = of(sending, facts.needs.shaded, "materials that a ray may meet ") + std::string(verb);
    if (beside > 0) {
      choice.fact += "; " + std::to_string(beside) + " that no ray can meet would";
    }
    if (needed && sending == 0) {
      choice.fact += ", but light that cannot be refracted is reflected";
    }
  }
  // Both kinds are decided by one test at each point.
  const auto pixels = std::int64_t{facts.render.width} * facts.render.height * facts.render.samples;
  return entry_of(item, PlanClass::proved, facts.keep, std::move(choice), "tests at points",
                  {0, in_one_go ? pixels : 0});
}

PlanEntry textures(const PlanFacts& facts) {
  const SceneNeeds& needs = facts.needs;
  const auto used = static_cast<std::uint64_t>(std::ranges::count(needs.textures, true));
  Choice choice;
  choice.exists = !needs.textures.empty();
  choice.needed = used == needs.textures.size();
  choice.fact = choice.exists
                    ? of(used, needs.textures.size(), "textures may colour a point that a ray meets")
                    : "the scene has no textures";
  const std::int64_t texels = integer(facts.texels - facts.texels_needed);
  return entry_of(PlanItem::textures, PlanClass::proved, facts.keep, std::move(choice), "texels decoded",
                  {texels * texel_bytes, texels});
}

PlanEntry coordinates(const PlanFacts& facts) {
  Choice choice;
  choice.exists = facts.coordinates > 0;
  choice.needed = facts.needs.coordinates;
  choice.fact = choice.exists ? of(facts.needs.textured, facts.needs.shaded,
                                   "materials that a ray may meet have a texture")
                              : "the scene has no texture coordinates";
  return entry_of(PlanItem::texture_coordinates, PlanClass::proved, facts.keep, std::move(choice), "vertices",
                  {integer(facts.coordinates) * coordinate_bytes, integer(facts.coordinates)});
}

PlanEntry normals(const PlanFacts& facts) {
  const SceneNeeds& needs = facts.needs;
  Choice choice;
  choice.exists = facts.normals > 0;
  choice.needed = needs.normals;
  if (!choice.exists) {
    choice.fact = "the scene has no normals of vertices";
  } else {
    choice.fact = std::to_string(needs.smooth) + " triangles that a ray may meet are shaded by them";
  }
  return entry_of(PlanItem::normals, PlanClass::proved, facts.keep, std::move(choice), "vertices",
                  {integer(facts.normals) * normal_bytes, integer(facts.normals)});
}

PlanEntry unreachable(const PlanFacts& facts) {
  Choice choice;
  choice.exists = !facts.file.parts.empty();
  choice.fact = choice.exists ? "" : "the scene comes from no file";
  std::int64_t unused = 0;
  for (const scenes::PartUse& part : facts.file.parts) {
    if (part.used < part.all) {
      choice.fact += (choice.fact.empty() ? "" : ", ") + of(part.all - part.used, part.all, part.name);
      unused += integer(part.all - part.used);
    }
  }
  if (choice.exists && unused == 0) {
    choice.needed = true;
    choice.fact = "the scene uses every part of its file";
  } else if (choice.exists) {
    choice.fact += " of the file are of no use to this scene and camera";
  }
  return entry_of(PlanItem::unreachable, PlanClass::proved, facts.keep, std::move(choice),
                  "parts of the file", {integer(facts.file.unread_bytes), unused});
}

PlanEntry structures(const PlanFacts& facts) {
  // Those that sort primitives into cells: a bounding volume hierarchy divides lists of them instead.
  const auto kinds = accel::structure_kinds();
  const auto others = std::ranges::count_if(kinds, [&](std::string_view kind) {
    return kind != facts.structure && kind != accel::BruteForce::kind_name && kind != accel::Bvh::kind_name;
  });
  return entry_of(PlanItem::structures, PlanClass::proved, facts.keep,
                  {true, false, "structure.kind is " + facts.structure + "; no other kind is built"},
                  "primitives sorted", {0, others * integer(facts.needs.primitives)});
}

}  // namespace

PlanFacts facts_of_frame(const scenes::Scene& scene, const processors::program::RenderOptions& render,
                         const std::string& structure, const KeptItems& keep) {
  PlanFacts facts;
  facts.needs = needs_of(scene, render);
  facts.render = render;
  facts.structure = structure;
  facts.keep = keep;
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    facts.texels += scene.textures[i].size();
    facts.texels_needed += facts.needs.textures[i] ? scene.textures[i].size() : 0;
  }
  facts.coordinates = scene.uvs.size();
  facts.normals = scene.normals.size();
  return facts;
}

Plan make_plan(const PlanFacts& facts, std::vector<PlanEntry> further) {
  const SceneNeeds& needs = facts.needs;
  Plan plan;
  plan.entries.push_back(shadow_rays(facts));
  plan.entries.push_back(spawned_rays(facts, PlanItem::reflection_rays, needs.reflection_rays,
                                      needs.reflecting, needs.reflecting_beside, "reflect", true));
  plan.entries.push_back(spawned_rays(facts, PlanItem::refraction_rays, needs.refraction_rays,
                                      needs.transmitting, needs.transmitting_beside, "let light through",
                                      false));
  plan.entries.push_back(textures(facts));
  plan.entries.push_back(coordinates(facts));
  plan.entries.push_back(normals(facts));
  plan.entries.push_back(unreachable(facts));
  plan.entries.push_back(structures(facts));
  add_entries(plan, std::move(further));
  return plan;
}

void plan_structure(Plan& plan, const PlanFacts& facts, const accel::Structure& structure) {
  const accel::Topology& topology = structure.topology();
  Choice mailboxes;
  mailboxes.exists = facts.render.mailboxes;
  if (!mailboxes.exists) {
    mailboxes.fact = "structure.mailboxes is false";
  } else {
    std::vector<bool> listed(structure.triangles().size());
    std::uint64_t again = 0;
    for (const std::uint32_t id : topology.entries) {
      again += listed[id] ? 1U : 0U;
      listed[id] = true;
    }
    // A walk that pushes a point from leaf to leaf may come upon a leaf twice.
    const bool pushes = accel::traversal_of(structure) == accel::Traversal::bsp_push_point;
    mailboxes.needed = again > 0 || pushes;
    mailboxes.fact = std::to_string(again) + " of " + std::to_string(topology.entries.size()) +
                     " entries of the lists name a primitive that another names too";
    if (pushes && again == 0) {
      mailboxes.fact += ", but this walk may come upon a leaf twice";
    }
  }
  add_entries(plan, {entry_of(PlanItem::mailboxes, PlanClass::proved, facts.keep, std::move(mailboxes),
                              "look-ups", {integer(structure.triangles().size()) * mailbox_bytes, 0})});
}

bool is_left_out(const Plan& plan, PlanItem item) {
  return std::ranges::any_of(plan.entries, [&](const PlanEntry& entry) {
    return entry.item == item && entry.decision == PlanDecision::left_out;
  });
}

processors::program::RenderOptions planned_options(const Plan& plan, const PlanFacts& facts) {
  processors::program::RenderOptions options = facts.render;
  // No material continues a chain of rays, so each chain is a single ray. The voxel cut, however, finds with
  // the depth from which level on voxels are small.
  if (is_left_out(plan, PlanItem::reflection_rays) && is_left_out(plan, PlanItem::refraction_rays) &&
      !facts.needs.diffuse_rays && facts.render.voxel_cut == 0.0) {
    options.max_depth = 1;
  }
  // Without shadows there are no shadow rays to keep.
  options.unlit_shadows = facts.render.shadows && facts.keep.has(PlanItem::shadow_rays);
  options.keep_mailboxes = !is_left_out(plan, PlanItem::mailboxes);
  return options;
}

void drop_parts(const Plan& plan, const SceneNeeds& needs, const scenes::ImageDecoder& decode,
                scenes::Scene& scene) {
  const bool without = is_left_out(plan, PlanItem::textures);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    scenes::Texture& texture = scene.textures[i];
    if (without && !needs.textures[i]) {
      texture.texels = {};
      texture.file.reset();
    } else if (texture.file != nullptr) {
      scenes::decode_texels(texture, decode);
    }
  }
  if (is_left_out(plan, PlanItem::texture_coordinates)) {
    scene.uvs = {};
  }
  if (is_left_out(plan, PlanItem::normals)) {
    scene.normals = {};
  }
}

}  // namespace marti::studies::run
