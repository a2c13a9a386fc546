#include "studies/stability/stability_keys.h"

#include <algorithm>
#include <string>

#include "sim/nearest.h"
#include "sim/shown.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/other_commands.h"

namespace marti::studies::stability {

void declare_stability_keys(sim::Schema& schema) {
  const CaseSize size;
  schema.section("stability", "only for `marti study stability`, whose scenes and machines are its own");
  schema.integer("stability.rays", size.rays, {100, 10'000'000}, "rays",
                 "of each geometry case, roughly, and references of each cache case");
  schema.texts("stability.only", {}, "cases that are run, by their names in the table; empty: all");
  schema.integer("stability.nodes", size.nodes, {64, 1 << 20}, "", "of the largest machine");
}

sim::Schema stability_schema() {
  sim::Schema schema;
  declare_stability_keys(schema);
  keys::declare_sections_of_other_commands(schema);
  return schema;
}

StabilityConfig read_stability(sim::Config& config, std::span<const StabilityCase> all) {
  StabilityConfig stability;
  stability.size.rays = keys::count(config, "stability.rays");
  stability.size.nodes = keys::count(config, "stability.nodes");
  const std::vector<std::string> only = config.texts("stability.only");
  config.refuse_unused();
  std::vector<std::string> names;
  for (const StabilityCase& one : all) {
    names.push_back(one.id);
    if (only.empty() || std::ranges::find(only, one.id) != only.end()) {
      stability.cases.push_back(one);
    }
  }
  for (const std::string& name : only) {
    if (std::ranges::find(names, name) == names.end()) {
      config.fail("stability.only",
                  "there is no case \"" + sim::shown(name) + "\"" + sim::did_you_mean(name, names));
    }
  }
  return stability;
}

}  // namespace marti::studies::stability
