#include "studies/run/plan/make_plan.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "accel/traversal.h"
#include "sim/error.h"

namespace marti::studies::run {

namespace {

constexpr const char* given_rays = "the rays of image.rays end at what they hit";

constexpr const char* gaussians = "Gaussians have light of their own, and rays go on through them";

bool looks_through(const PlanFacts& facts) {
  return facts.render.integrator == processors::program::Integrator::gaussians;
}

std::string of(std::uint64_t part, std::uint64_t whole, std::string_view what) {
  std::string text = std::to_string(part) + " of " + std::to_string(whole) + " ";
  return text.append(what);
}

// Whether an item exists and is needed, and the reason. Others are left out unless the user wants them kept.
struct Choice {
  bool exists = true;
  bool needed = false;
  std::string fact;
};

PlanEntry entry_of(PlanItem item, const KeptItems& keep, Choice choice) {
  const PlanDecision decision = !choice.exists   ? PlanDecision::not_applicable
                                : choice.needed  ? PlanDecision::needed
                                : keep.has(item) ? PlanDecision::kept
                                                 : PlanDecision::left_out;
  return {item, decision, std::move(choice.fact)};
}

PlanEntry shadow_rays(const PlanFacts& facts) {
  const SceneNeeds& needs = facts.needs;
  Choice choice;
  std::string lights = of(needs.shining_lights, needs.lights, "lights shine");
  if (facts.render.integrator == processors::program::Integrator::rays) {
    choice = {false, false, given_rays};
  } else if (looks_through(facts)) {
    choice = {false, false, gaussians};
  } else if (facts.render.integrator == processors::program::Integrator::occlusion) {
    choice = {true, true, "the rays into the hemisphere are all that is asked for"};
  } else if (!facts.render.shadows) {
    choice = {false, false, "image.shadows is false"};
  } else if (needs.shining_lights == 0) {
    choice = {false, false, std::move(lights)};
  } else if (needs.unlit == 0) {
    choice.needed = needs.shadow_rays;
    choice.exists = needs.shadow_rays;
    choice.fact = facts.render.integrator == processors::program::Integrator::shadow ? lights
                  : needs.shadow_rays ? lights + ", and every material that asks for them shows it"
                                      : "no material that a ray may meet asks for lights";
  } else {
    choice.fact = of(needs.unlit, needs.shaded, "materials that a ray may meet ask for lights and are black");
  }
  return entry_of(PlanItem::shadow_rays, facts.keep, std::move(choice));
}

PlanEntry spawned_rays(const PlanFacts& facts, PlanItem item, bool needed, std::uint64_t sending,
                       std::uint64_t beside, std::string_view verb) {
  Choice choice;
  if (facts.render.integrator == processors::program::Integrator::rays) {
    choice = {false, false, given_rays};
  } else if (looks_through(facts)) {
    choice = {needed, needed, gaussians};
  } else if (facts.render.max_depth <= 1) {
    choice = {false, false, "image.max_depth is 1"};
  } else {
    choice.needed = needed;
    choice.fact = (sending == 0 ? "none" : std::to_string(sending)) + " of the " +
                  std::to_string(facts.needs.shaded) + " materials that rays can reach " + std::string(verb);
    if (beside > 0) {
      choice.fact += "; " + std::to_string(beside) + " that none can reach would be";
    }
    if (needed && sending == 0) {
      choice.fact += ", but light that cannot be refracted is reflected";
    }
  }
  return entry_of(item, facts.keep, std::move(choice));
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
  if (needs.cut_out > 0) {
    choice.fact += "; " + std::to_string(needs.cut_out) + " materials are cut out by theirs";
  }
  return entry_of(PlanItem::textures, facts.keep, std::move(choice));
}

PlanEntry coordinates(const PlanFacts& facts) {
  Choice choice;
  choice.exists = facts.coordinates > 0;
  choice.needed = facts.needs.coordinates;
  choice.fact = choice.exists ? of(facts.needs.textured, facts.needs.shaded,
                                   "materials that a ray may meet have a texture")
                              : "the scene has no texture coordinates";
  return entry_of(PlanItem::texture_coordinates, facts.keep, std::move(choice));
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
  return entry_of(PlanItem::normals, facts.keep, std::move(choice));
}

PlanEntry unreachable(const PlanFacts& facts) {
  Choice choice;
  choice.exists = !facts.file.parts.empty();
  choice.fact = choice.exists ? "" : "the scene comes from no file";
  bool unused = false;
  for (const scenes::PartUse& part : facts.file.parts) {
    if (part.used < part.all) {
      choice.fact += (choice.fact.empty() ? "" : ", ") + of(part.all - part.used, part.all, part.name);
      unused = true;
    }
  }
  if (choice.exists && !unused) {
    choice.needed = true;
    choice.fact = "the scene uses every part of its file";
  } else if (choice.exists) {
    choice.fact += " of the file are of no use to this scene and camera";
  }
  return entry_of(PlanItem::unreachable, facts.keep, std::move(choice));
}

}  // namespace

PlanFacts facts_of_frame(const scenes::Scene& scene, const processors::program::RenderOptions& render,
                         const KeptItems& keep) {
  PlanFacts facts;
  facts.needs = needs_of(scene, render);
  facts.render = render;
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
                                      needs.reflecting, needs.reflecting_beside, "are reflective"));
  plan.entries.push_back(spawned_rays(facts, PlanItem::refraction_rays, needs.refraction_rays,
                                      needs.transmitting, needs.transmitting_beside, "are transparent"));
  plan.entries.push_back(textures(facts));
  plan.entries.push_back(coordinates(facts));
  plan.entries.push_back(normals(facts));
  plan.entries.push_back(unreachable(facts));
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
  add_entries(plan, {entry_of(PlanItem::mailboxes, facts.keep, std::move(mailboxes))});
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

void drop_parts(const Plan& plan, const SceneNeeds& needs, const scenes::ImageDecoder& decode, bool strict,
                scenes::Scene& scene) {
  const bool without = is_left_out(plan, PlanItem::textures);
  std::uint64_t undecoded = 0;
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    scenes::Texture& texture = scene.textures[i];
    if (without && !needs.textures[i]) {
      texture.texels = {};
      texture.file.reset();
    } else if (texture.file != nullptr) {
      try {
        scenes::decode_texels(texture, decode);
      } catch (const sim::UserError&) {
        if (strict) {
          throw;
        }
        ++undecoded;
        texture.file.reset();
      }
    }
  }
  if (undecoded > 0) {
    scene.notes.push_back("Replaced: " + std::to_string(undecoded) + " " +
                          std::string(scenes::undecoded_textures) + ".");
  }
  if (is_left_out(plan, PlanItem::texture_coordinates)) {
    scene.uvs = {};
  }
  if (is_left_out(plan, PlanItem::normals)) {
    scene.normals = {};
  }
}

void check_plan(const Plan& plan, const SceneNeeds& needs, const processors::program::Frame& frame,
                std::span<const std::uint64_t> shades) {
  using processors::program::RayKind;
  for (std::size_t i = 0; i < needs.materials.size(); ++i) {
    sim::ensure(needs.materials[i] || shades[i] == 0,
                "the plan took a material for one that no ray can meet, and a ray has met it");
  }
  const auto none = [&](RayKind kind) { return frame.rays.traced[static_cast<std::size_t>(kind)] == 0; };
  sim::ensure(needs.shadow_rays || !is_left_out(plan, PlanItem::shadow_rays) || none(RayKind::shadow),
              "the plan left out all shadow rays, and one was sent");
  sim::ensure(needs.reflection_rays || none(RayKind::reflection),
              "the plan left out reflected rays, and one was sent");
  sim::ensure(needs.refraction_rays || none(RayKind::refraction),
              "the plan left out refracted rays, and one was sent");
  sim::ensure(needs.diffuse_rays || none(RayKind::diffuse),
              "the plan has no use for diffuse rays, and one was sent");
}

}  // namespace marti::studies::run
