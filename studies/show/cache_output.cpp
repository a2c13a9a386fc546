#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;
using processors::machine::SecondLevel;

}  // namespace

nlohmann::ordered_json second_level_json(const run::RunResult& r) {
  const SecondLevel sharing = r.machine.l2.sharing;
  if (sharing == SecondLevel::none) {
    return nullptr;
  }
  Json caches = counters_list(r.timed.l2.caches);
  for (std::size_t i = 0; i < std::min(caches.size(), r.timed.l2.waits.size()); ++i) {
    add_counters(caches[i], r.timed.l2.waits[i], "wait_");
  }
  return {{"sharing", processors::machine::second_level_names[static_cast<std::size_t>(sharing)]},
          {"line", processors::machine::second_level_cache(r.machine).line},
          {"per_cache", caches}};
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
