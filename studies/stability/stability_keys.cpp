#include "studies/stability/stability_keys.h"

namespace marti::studies {

void declare_stability_keys(sim::Schema& schema) {
  const CaseSize size;
  schema.section("stability", "only for `marti study stability`, whose scenes and machines are its own");
  schema.integer("stability.rays", size.rays, {100, 10'000'000}, "rays",
                 "of each geometry case, roughly, and references of each cache case");
  schema.integer("stability.nodes", size.nodes, {64, 1 << 20}, "", "of the largest machine");
}

sim::Schema stability_schema() {
  sim::Schema schema;
  declare_stability_keys(schema);
  return schema;
}

CaseSize read_stability(sim::Config& config) {
  CaseSize size;
  size.rays = static_cast<std::uint32_t>(config.integer("stability.rays"));
  size.nodes = static_cast<std::uint32_t>(config.integer("stability.nodes"));
  config.refuse_unused();
  return size;
}

}  // namespace marti::studies
