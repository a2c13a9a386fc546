#include "studies/show/cache_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "studies/show/json_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;
using processors::machine::SecondLevel;

}  // namespace

nlohmann::ordered_json second_level_json(const processors::machine::MachineConfig& machine,
                                         const processors::replay::MachineResult& result, bool per_cache) {
  Json object = {
      {"sharing", processors::machine::second_level_names[static_cast<std::size_t>(machine.l2.sharing)]},
      {"line", processors::machine::second_level_cache(machine).line}};
  Json caches = nullptr;
  if (per_cache) {
    caches = Json::array();
    for (std::size_t i = 0; i < result.l2.caches.size(); ++i) {
      Json& cache = caches.emplace_back(Json::object());
      add_counters(cache, result.l2.caches[i]);
      if (i < result.l2.waits.size()) {
        add_counters(cache, result.l2.waits[i], "wait_");
      }
    }
  }
  object["per_cache"] = caches;
  return object;
}

std::string second_level_line(const run::RunResult& r) {
  const SecondLevel sharing = r.machine.l2.sharing;
  if (sharing == SecondLevel::none) {
    return {};
  }
  const std::optional<double> hit_ratio = r.figure("l2_hit_ratio");
  return fmt::format("second level  {}: {} look-ups, {} misses, {}\n",
                     sharing == SecondLevel::shared ? "one a cluster" : "one a node",
                     tables::grouped(r.count("l2_hits") + r.count("l2_misses")),
                     tables::grouped(r.count("l2_misses")),
                     hit_ratio ? "hit ratio " + tables::percent(*hit_ratio) : "never asked");
}

}  // namespace marti::studies::show
