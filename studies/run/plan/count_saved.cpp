#include "processors/program/shading.h"
#include "sim/error.h"
#include "studies/run/plan/make_plan.h"

namespace marti::studies {

namespace {

// What a log touches.
struct Touched {
  std::vector<std::uint64_t> shades;  // points by material; averaged materials beyond the scene's
  std::uint64_t lookups = 0;
  std::uint64_t points = 0;
};

Touched touched_by(const processors::WorkLog& log) {
  Touched touched;
  touched.shades.resize(log.materials);
  for (const processors::LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size(); at += processors::step_words(&row.words[at])) {
      const processors::Step step = processors::step_of(row.words[at]);
      const std::uint32_t operand = processors::operand_of(row.words[at]);
      if (step == processors::Step::leaf) {
        touched.lookups += log.topology.nodes[operand].count;
      } else if (step == processors::Step::partial_leaf || step == processors::Step::mailed_leaf) {
        touched.lookups += row.words[at + 1];
      } else if (step == processors::Step::shade) {
        ++touched.shades[operand];
        ++touched.points;
      }
    }
  }
  return touched;
}

void check_unused(const Touched& touched, const SceneNeeds& needs) {
  for (std::size_t i = 0; i < needs.materials.size(); ++i) {
    sim::ensure(needs.materials[i] || touched.shades[i] == 0,
                "the plan took a material for one that no ray can meet, and a ray has met it");
  }
}

}  // namespace

void count_saved(Plan& plan, const SceneNeeds& needs, const scenes::Scene& scene,
                 const processors::Frame& frame) {
  const Touched touched = touched_by(*frame.log);
  check_unused(touched, needs);
  const auto& traced = frame.rays.traced;
  const auto traced_of = [&](processors::RayKind kind) { return traced[static_cast<std::size_t>(kind)]; };
  sim::ensure(needs.shadow_rays || !is_left_out(plan, PlanItem::shadow_rays) ||
                  traced_of(processors::RayKind::shadow) == 0,
              "the plan left out all shadow rays, and one was sent");
  sim::ensure(needs.reflection_rays || traced_of(processors::RayKind::reflection) == 0,
              "the plan left out reflected rays, and one was sent");
  sim::ensure(needs.refraction_rays || traced_of(processors::RayKind::refraction) == 0,
              "the plan left out refracted rays, and one was sent");
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
          const bool unlit = processors::asks_lights(material) && !processors::shows_light(material);
          asked += unlit ? touched.shades[i] * needs.shining_lights : 0;
        }
        counted.operations = static_cast<std::int64_t>(asked);
        break;
      }
      case PlanItem::reflection_rays:
        counted.operations = static_cast<std::int64_t>(touched.points);
        break;
      case PlanItem::mailboxes:
        counted.operations = static_cast<std::int64_t>(touched.lookups);
        break;
      default:
        break;
    }
    entry.counted = counted;
  }
}

}  // namespace marti::studies
