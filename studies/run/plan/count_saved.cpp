#include "processors/program/shading.h"
#include "sim/error.h"
#include "studies/run/plan/make_plan.h"

namespace marti::studies::run {

namespace {

void check_unused(std::span<const std::uint64_t> shades, const SceneNeeds& needs) {
  for (std::size_t i = 0; i < needs.materials.size(); ++i) {
    sim::ensure(needs.materials[i] || shades[i] == 0,
                "the plan took a material for one that no ray can meet, and a ray has met it");
  }
}

}  // namespace

void count_saved(Plan& plan, const SceneNeeds& needs, const scenes::Scene& scene,
                 const processors::program::Frame& frame, const processors::program::LogTotals& totals,
                 std::span<const std::uint64_t> shades) {
  check_unused(shades, needs);
  const auto& traced = frame.rays.traced;
  const auto traced_of = [&](processors::program::RayKind kind) {
    return traced[static_cast<std::size_t>(kind)];
  };
  sim::ensure(needs.shadow_rays || !is_left_out(plan, PlanItem::shadow_rays) ||
                  traced_of(processors::program::RayKind::shadow) == 0,
              "the plan left out all shadow rays, and one was sent");
  sim::ensure(needs.reflection_rays || traced_of(processors::program::RayKind::reflection) == 0,
              "the plan left out reflected rays, and one was sent");
  sim::ensure(needs.refraction_rays || traced_of(processors::program::RayKind::refraction) == 0,
              "the plan left out refracted rays, and one was sent");
  sim::ensure(needs.diffuse_rays || traced_of(processors::program::RayKind::diffuse) == 0,
              "the plan has no use for diffuse rays, and one was sent");
  for (PlanEntry& entry : plan.entries) {
    if (entry.decision != PlanDecision::left_out) {
      continue;
    }
    PlanCost counted = entry.saved;  // already exact for an item that is left out as a whole
    switch (entry.item) {
      case PlanItem::shadow_rays: {
        std::uint64_t asked = 0;
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
          const scenes::Material& material = scene.materials[i];
          const bool unlit =
              processors::program::asks_lights(material) && !processors::program::shows_light(material);
          asked += unlit ? shades[i] * needs.shining_lights : 0;
        }
        counted.operations = static_cast<std::int64_t>(asked);
        break;
      }
      case PlanItem::reflection_rays:
        counted.operations = static_cast<std::int64_t>(totals.shades);
        break;
      case PlanItem::mailboxes:
        counted.operations = static_cast<std::int64_t>(totals.lookups);
        break;
      default:
        break;
    }
    entry.counted = counted;
  }
}

}  // namespace marti::studies::run
