#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "memory/dram_presets.h"
#include "processors/energy/dram_energy.h"
#include "sim/statistics.h"
#include "sim/units.h"
#include "studies/keys/setting_value.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/show/text_columns.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

// "memory.clock is 33 MHz, the default, beside node.clock of 1.5 GHz".
std::vector<std::string> clock_notes(const std::vector<sim::EffectiveValue>& values) {
  constexpr double far = 4.0;
  const auto hertz = [](const sim::EffectiveValue& value) {
    return sim::parse_frequency(keys::plain_setting(value.value));
  };
  const sim::EffectiveValue* fastest = nullptr;
  for (const sim::EffectiveValue& value : values) {
    if (value.key.ends_with(".clock") && value.given &&
        (fastest == nullptr || hertz(value) > hertz(*fastest))) {
      fastest = &value;
    }
  }
  std::vector<std::string> notes;
  for (const sim::EffectiveValue& value : values) {
    // A clock of 0 Hz is that of another part, which is in the list itself.
    if (fastest != nullptr && value.key.ends_with(".clock") && !value.given && hertz(value) > 0.0 &&
        hertz(*fastest) > far * hertz(value)) {
      notes.push_back(fmt::format("{} is {}, the default, beside {} of {}", value.key,
                                  keys::plain_setting(value.value), fastest->key,
                                  keys::plain_setting(fastest->value)));
    }
  }
  return notes;
}

}  // namespace

nlohmann::ordered_json notes_json(const run::RunResult& r) { return clock_notes(r.values); }

std::string note_lines(const run::RunResult& r) {
  std::string text;
  for (const std::string& note : clock_notes(r.values)) {
    text += fmt::format("  {:<12}{}\n", "note", note);
  }
  return text;
}

nlohmann::ordered_json context_json(const run::RunResult& r) {
  if (r.timed.contexts.nodes.empty()) {
    return nullptr;
  }
  return {{"contexts", r.machine.contexts}, {"per_node", counters_list(r.timed.contexts.nodes)}};
}

std::string context_lines(const run::RunResult& r) {
  std::string text;
  if (r.timed.contexts.nodes.empty()) {
    return text;
  }
  const auto out = std::back_inserter(text);
  if (r.machine.contexts > 1) {
    fmt::format_to(out, "contexts      {} a node, {} switches, {} waits for a line that another fetched\n",
                   r.machine.contexts, tables::grouped(r.count("contexts_switches")),
                   tables::grouped(r.count("contexts_joined")));
  }
  if (r.machine.prefetch.on() || r.machine.prefetch.into_unit()) {
    const std::optional<double> useful = sim::ratio(r.count("contexts_useful"), r.count("contexts_issued"));
    fmt::format_to(out, "prefetch      {} lines, {} of them useful, {} waits for one under way, {} dropped\n",
                   tables::grouped(r.count("contexts_issued")), useful ? tables::percent(*useful) : "-",
                   tables::grouped(r.count("contexts_late")), tables::grouped(r.count("contexts_dropped")));
  }
  return text;
}

nlohmann::ordered_json simt_json(const run::RunResult& r) {
  if (r.timed.simt.nodes.empty()) {
    return nullptr;
  }
  return {{"lanes", r.machine.simt.lanes},
          {"warps", r.machine.simt.warps},
          {"warps_in_unit", r.machine.rt.warps},
          {"per_node", counters_list(r.timed.simt.nodes)}};
}

std::string simt_lines(const run::RunResult& r) {
  constexpr double mega = 1e6;
  if (r.timed.simt.nodes.empty()) {
    return {};
  }
  const auto percent = [](std::optional<double> share) { return share ? tables::percent(*share) : "-"; };
  const auto number = [&](std::string_view figure) { return r.figure(std::string(figure)).value_or(0.0); };
  std::string text =
      fmt::format("SIMT          {} warps of {} lanes a node, {}; lanes busy {} of the time\n",
                  r.machine.simt.warps, r.machine.simt.lanes,
                  r.machine.rt.warps > 0 ? fmt::format("{:.2f} of {} places in the unit taken",
                                                       number("simt_mean_warps"), r.machine.rt.warps)
                                         : "no ray-tracing unit",
                  percent(r.figure("simt_efficiency")));
  const auto out = std::back_inserter(text);
  std::int64_t all = 0;
  const auto of_state = [&](std::string_view state) { return r.count("simt_lanes_" + std::string(state)); };
  constexpr std::array<std::pair<std::string_view, std::string_view>, processors::walk::lane_states> states =
      {{
          {"shading", "shade"},
          {"slot", "wait for a slot"},
          {"unit", "for the unit"},
          {"scheduler", "for their look-up"},
          {"cache", "for the cache"},
          {"memory", "for memory"},
          {"box", "test boxes"},
          {"primitive", "test primitives"},
          {"held", "are held by their warp"},
          {"empty", "have no pixel"},
      }};
  for (const auto& [name, words] : states) {
    all += of_state(name);
  }
  fmt::format_to(out, "  {:<12}", "lanes");
  for (const auto& [name, words] : states) {
    fmt::format_to(out, "{}{} {}",
                   name == "shading"                      ? ""
                   : name == "scheduler" || name == "box" ? ",\n              "
                                                          : ", ",
                   words, percent(sim::ratio(of_state(name), all)));
  }
  fmt::format_to(
      out,
      "\n  {:<12}{:.2f} lanes an access; mean {:.1f} of {} under way, {} joined; none free {} of the time\n",
      "lines", number("simt_lanes_an_access"), number("simt_mean_lines"), r.machine.simt.mshrs,
      tables::grouped(r.count("simt_joined")), percent(r.figure("simt_full_share")));
  if (r.machine.rt.stack > 0) {
    fmt::format_to(out, "  {:<12}{} lines written, {} read back; {} entries of a lane on chip\n", "stacks",
                   tables::grouped(r.count("simt_spills")), tables::grouped(r.count("simt_fills")),
                   r.machine.rt.stack);
  }
  if (r.machine.rt.share != processors::machine::RtShare::none) {
    fmt::format_to(out, "  {:<12}{} nodes that waited were taken by lanes without work\n", "sharing",
                   tables::grouped(r.count("simt_helps")));
  }
  if (r.machine.rt.sort != processors::machine::RaySort::none) {
    fmt::format_to(out, "  {:<12}{} warps of sorted rays, {:.1f} of {} lanes filled\n", "sorting",
                   tables::grouped(r.count("simt_sorted_warps")), number("simt_lanes_filled"),
                   r.machine.simt.lanes);
  }
  const processors::program::LogTotals& log = r.functional.totals;
  fmt::format_to(
      out, "  {:<12}{:.1f} visits on average, {} at most of 95 %, the most {}; {:.0f} bytes from memory\n",
      "rays", number("visits_a_ray"), tables::grouped(log.visits_95), tables::grouped(log.most_visits),
      number("memory_bytes_a_ray"));
  fmt::format_to(out, "  {:<12}{:.0f} cycles on average, the longest {}; the slowest warp {} for a packet\n",
                 "", number("simt_ray_latency"), tables::grouped(r.count("simt_longest_ray")),
                 tables::grouped(r.count("simt_longest_warp")));
  fmt::format_to(out, "  {:<12}{:.4g} M a second", "", number("rays_a_second") / mega);
  const char* before = ": ";
  for (std::size_t kind = 0; kind < processors::program::ray_kinds; ++kind) {
    if (log.rays[kind] > 0) {
      const std::string name(processors::program::ray_kind_names[kind]);
      fmt::format_to(out, "{}{} {:.4g}", before, name, number("rays_a_second_" + name) / mega);
      before = ", ";
    }
  }
  text += "\n";
  return text;
}

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

namespace {

using processors::energy::EnergyResult;

double in_joules(std::int64_t femtojoules) { return static_cast<double>(femtojoules) / 1e15; }

double share(std::int64_t part, const EnergyResult& energy) {
  return energy.total > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(energy.total) : 0.0;
}

}  // namespace

std::string energy_lines(const run::RunResult& result) {
  std::string text;
  if (!result.timed.energy) {
    return text;
  }
  const EnergyResult& energy = *result.timed.energy;
  constexpr auto counters = EnergyResult::counters();
  const auto* const end = counters.begin() + processors::energy::energy_parts;
  const auto* const largest = std::max_element(counters.begin(), end, [&](const auto& a, const auto& b) {
    return energy.*a.member < energy.*b.member;
  });
  const std::optional<double> power = result.figure("power");
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\nenergy        {} a frame, {} W; its largest part is {} ({:.2f} %)\n",
                 tables::joules(in_joules(energy.total)), power ? fmt::format("{:.3g}", *power) : "-",
                 largest->name, share(energy.*largest->member, energy));
  for (const auto* part = counters.begin(); part != end; ++part) {
    if (energy.*part->member > 0) {
      fmt::format_to(out, "  {:<14}{:>12} {:>8.2f} %\n", part->name,
                     tables::joules(in_joules(energy.*part->member)), share(energy.*part->member, energy));
    }
  }
  if (const auto& dram = result.machine.banks.dram) {
    const processors::machine::EnergyFigures& figures = result.machine.energy.figures;
    const processors::energy::DramEnergy& known = processors::energy::dram_energy(dram->preset);
    const bool given = figures.memory_access != known.activation || figures.memory_read != known.read ||
                       figures.memory_write != known.write;
    fmt::format_to(out, "  {} takes {:.4g} pJ a row opened, {:.4g} a byte read, {:.4g} a byte written ({})\n",
                   memory::dram_preset_names.at(dram->preset), figures.memory_access, figures.memory_read,
                   figures.memory_write, given ? "given by keys" : known.source);
  }
  fmt::format_to(out, "  {:.4g} rays a joule, {:.4g} uJ s, {:.4g} mm2 of nodes and caches\n",
                 result.figure("rays_a_joule").value_or(0.0), result.figure("energy_delay").value_or(0.0),
                 result.figure("area").value_or(0.0));
  if (result.machine.has_rt_unit()) {
    constexpr double square = 1e6;
    fmt::format_to(
        out, "  {:.4g} mm2 of them in caches, {:.4g} in ray-tracing units; {:.4g} M rays a second and mm2\n",
        static_cast<double>(energy.cache_area) / square, static_cast<double>(energy.unit_area) / square,
        result.figure("rays_a_second_mm2").value_or(0.0) / square);
  }
  return text;
}

nlohmann::ordered_json build_json(const run::RunResult& r) {
  const processors::node::BuildResult& build = r.timed.build;
  if (build.sharing == processors::machine::Sharing::given) {
    return nullptr;
  }
  return {{"sharing", processors::machine::sharing_names[static_cast<std::size_t>(build.sharing)]},
          {"levels", counters_list(build.levels)},
          {"per_node", counters_list(build.nodes)}};
}

std::string build_lines(const run::RunResult& r) {
  const processors::node::BuildResult& build = r.timed.build;
  std::string text;
  if (build.sharing == processors::machine::Sharing::given) {
    return text;
  }
  fmt::format_to(std::back_inserter(text),
                 "\nbuilding      {} before the frame, {} of its time; {} during it, {} lock waits",
                 tables::grouped(r.count("build_start_up_splits")),
                 tables::percent(sim::ratio(r.count("build_start_up"), r.count("end")).value_or(0.0)),
                 tables::grouped(r.count("build_splits")), tables::grouped(r.count("build_waits")));
  if (const std::int64_t wasted = r.count("build_wasted_splits"); wasted != 0) {
    text += fmt::format(", {} made more than once", tables::grouped(wasted));
  }
  const TextColumns table = {8, {10, 10, 10, 12, 12, 12, 14}};
  text += "\n" + table.row("  level", {"branches", "leaves", "partial", "node bytes", "list bytes",
                                       "released", "visits"});
  const auto line = [&](const std::string& name, const processors::node::BuildLevel& level) {
    std::vector<std::string> cells;
    for (const std::int64_t count : {level.branches, level.leaves, level.partial, level.node_bytes,
                                     level.list_bytes, level.released_bytes, level.visits}) {
      cells.push_back(std::to_string(count));
    }
    text += table.row("  " + name, cells);
  };
  for (std::size_t level = 0; level < build.levels.size(); ++level) {
    line(std::to_string(level + 1), build.levels[level]);
  }
  line("all", r.counters<processors::node::BuildLevel>("tree_"));
  return text;
}

}  // namespace marti::studies::show
