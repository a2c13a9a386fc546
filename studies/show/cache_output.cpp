#include "studies/show/cache_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "studies/show/json_parts.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;
using processors::SecondLevel;

}  // namespace

nlohmann::ordered_json second_level_json(const processors::MachineConfig& machine,
                                         const processors::MachineResult& result, bool per_cache) {
  Json object = {{"sharing", processors::second_level_names[static_cast<std::size_t>(machine.l2.sharing)]},
                 {"line", processors::second_level_cache(machine).line}};
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

std::string second_level_line(const processors::MachineConfig& machine,
                              const processors::MachineResult& result) {
  if (machine.l2.sharing == SecondLevel::none) {
    return {};
  }
  const memory::CacheCounters sum = result.l2.counters();
  const std::int64_t asked = sum.references();
  return fmt::format("second level  {}: {} look-ups, {} misses, {}\n",
                     machine.l2.sharing == SecondLevel::shared ? "one a cluster" : "one a node", asked,
                     sum.misses,
                     asked == 0 ? std::string("never asked")
                                : fmt::format("hit ratio {:.2f} %", 100.0 * static_cast<double>(sum.hits) /
                                                                        static_cast<double>(asked)));
}

}  // namespace marti::studies
