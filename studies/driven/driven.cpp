#include "studies/driven/driven.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "processors/energy/energy.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "studies/driven/memory_tables.h"
#include "studies/driven/served.h"
#include "studies/figures/counted_figures.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/setting_value.h"
#include "studies/show/result_parts.h"
#include "studies/sweep/plan/axis_values.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"
#include "studies/version.h"

namespace marti::studies::driven {

namespace {

using nlohmann::ordered_json;
using processors::energy::EnergyResult;

constexpr double median = 50.0;

// Figures of the parts that the memory has; those of nodes, which there are none of, are left out.
bool is_of_memory(std::string_view name) {
  for (const std::string_view part : {"interconnect_", "bank_", "dram_", "l2_"}) {
    if (name.starts_with(part)) {
      return true;
    }
  }
  constexpr std::array<std::string_view, 7> others = {
      "end", "energy_l1", "energy_l2", "energy_interconnect", "energy_memory", "energy_total", "power"};
  return std::ranges::find(others, name) != others.end();
}

std::string answer_of(const Served& served) {
  return fmt::format("{:.4g} GB/s; a read takes {:.2f} ns, 95 % below {:.2f} ns, the longest {:.2f} ns",
                     served.bytes_a_second() / giga, served.mean_latency() / nanosecond,
                     static_cast<double>(served.latency(late)) / nanosecond,
                     static_cast<double>(served.driven.latency.max) / nanosecond);
}

std::string trace_line(const Served& served, const std::string& name) {
  return fmt::format("trace         {}: {}, {}, {}, {}, {}\n", name, tables::counted(served.reads, "read"),
                     tables::counted(served.writes, "write"),
                     tables::bytes(static_cast<double>(served.bytes)), served.form,
                     served.timed ? "each at its time" : "each as soon as there is a place for it");
}

// Of nodes, which there are none of, and of leakage nothing is known.
std::string energy_line(const Served& served) {
  if (!served.result.timed.energy) {
    return {};
  }
  const EnergyResult& energy = *served.result.timed.energy;
  constexpr double joule = 1e15;  // in fJ
  std::string text =
      fmt::format("energy        {}, {:.3g} pJ a byte",
                  tables::joules(static_cast<double>(energy.total) / joule), served.picojoules_a_byte());
  constexpr auto counters = EnergyResult::counters();
  for (std::size_t i = 0; i < processors::energy::energy_parts; ++i) {
    if (const std::int64_t part = energy.*counters[i].member; part > 0) {
      text += fmt::format(", {} {}", counters[i].name,
                          tables::percent(static_cast<double>(part) / static_cast<double>(energy.total)));
    }
  }
  return text + "\n";
}

std::string text_of(const Served& served, const std::string& name, const DrivenChoices& choices) {
  const run::RunResult& result = served.result;
  std::string text = trace_line(served, name);
  text += fmt::format("places        {} reads of a node under way at a time; {} waited for a place\n",
                      choices.outstanding, tables::counted(served.driven.late, "request"));
  text += fmt::format("time          {}\n", tables::seconds(result.timed.end));
  if (choices.caches) {
    const processors::cost::ReferenceCounts& references = served.driven.references;
    text += fmt::format("caches        {} hits, {} misses ({} hit)\n", tables::grouped(references.all_hits()),
                        tables::grouped(references.all_misses()), tables::percent(served.hit_ratio()));
  }
  text += show::second_level_line(result);
  if (const std::string link = show::interconnect_bandwidth_line(result); !link.empty()) {
    text += "interconnect\n" + link;
  }
  if (result.machine.banks.dram) {
    text += fmt::format("dram          {} of bursts find their row open, {} find another one\n",
                        tables::percent(result.figure("dram_row_hit_ratio").value_or(0.0)),
                        tables::percent(result.figure("dram_row_conflict_ratio").value_or(0.0)));
    text += show::dram_bandwidth_line(result);
  }
  return text + energy_line(served);
}

ordered_json json_of(const Served& served, const std::string& name) {
  ordered_json figures = ordered_json::object();
  figures::for_each_count(figures::counted_figures(), served.result.counts,
                          [&](const std::string& figure, figures::Count value) {
                            if (is_of_memory(figure)) {
                              figures[figure] = tables::json_of(tables::Cell(value));
                            }
                          });
  figures::for_each_derived({&served.result.counts}, [&](const std::string& figure, double value) {
    if (is_of_memory(figure)) {
      figures[figure] = value;
    }
  });
  const processors::cost::ReferenceCounts& references = served.driven.references;
  ordered_json json = {{"marti", {{"version", version}}},
                       {"trace",
                        {{"file", name},
                         {"form", served.form},
                         {"timed", served.timed},
                         {"reads", served.reads},
                         {"writes", served.writes},
                         {"bytes", served.bytes}}},
                       {"latency",
                        {{"mean", served.mean_latency()},
                         {"p50", served.latency(median)},
                         {"p95", served.latency(late)},
                         {"max", served.driven.latency.max},
                         {"waited_for_a_place", served.driven.late}}},
                       {"figures", std::move(figures)}};
  if (served.result.timed.energy) {
    json["energy_pj_a_byte"] = served.picojoules_a_byte();
  }
  if (references.all_hits() + references.all_misses() > 0) {
    json["caches"] = {{"hits", references.all_hits()}, {"misses", references.all_misses()}};
  }
  return json;
}

// The configurations of some axes, the last one changing fastest.
std::vector<std::vector<sim::Setting>> settings_of(const sim::Config& config,
                                                   const std::vector<std::string>& arguments) {
  constexpr std::size_t most = 4096;
  std::vector<std::vector<sim::Setting>> points = {{}};
  for (const std::string& argument : arguments) {
    const sweep::AxisArgument axis = sweep::read_axis_argument(config, argument);
    std::vector<std::vector<sim::Setting>> more;
    for (const std::vector<sim::Setting>& point : points) {
      for (const sim::Setting& step : axis.steps) {
        if (std::ranges::find(point, axis.key, &sim::Setting::key) != point.end()) {
          throw sim::UserError("--axis " + argument + ": the key has an axis already");
        }
        more.push_back(point);
        more.back().push_back(step);
      }
    }
    points = std::move(more);
    if (points.size() > most) {
      throw sim::UserError(fmt::format("--axis {}: the axes have more than {} combinations", argument, most));
    }
  }
  return points;
}

std::string shown_setting(const sim::Schema& schema, const sim::Setting& setting) {
  return keys::plain_setting(sim::print_values(schema.keys()[setting.key], setting.values));
}

std::vector<Memory> serve_all(sim::Config& config, const std::filesystem::path& trace,
                              const DrivenChoices& choices, sim::WorkMeter* meter) {
  std::vector<Memory> memories;
  if (choices.axes.empty()) {
    memories.push_back({{}, serve(config, trace, choices, meter)});
    return memories;
  }
  if (!std::filesystem::is_regular_file(trace)) {
    throw sim::UserError(trace.string() +
                         ": is no file, and with --axis the trace is read again for each value");
  }
  for (const std::vector<sim::Setting>& point : settings_of(config, choices.axes)) {
    sim::Config of_point = config.with(point);
    Memory memory;
    for (const sim::Setting& setting : point) {
      memory.settings.emplace_back(config.schema().keys()[setting.key].name,
                                   shown_setting(config.schema(), setting));
    }
    memory.served = sim::with_places(of_point, [&] { return serve(of_point, trace, choices, meter); });
    memories.push_back(std::move(memory));
  }
  return memories;
}

ordered_json json_of(const std::vector<Memory>& memories, const std::string& name) {
  ordered_json array = ordered_json::array();
  for (const Memory& memory : memories) {
    ordered_json json = {{"settings", ordered_json::object()}};
    for (const auto& [key, value] : memory.settings) {
      json["settings"][key] = value;
    }
    json.update(json_of(memory.served, name));
    array.push_back(std::move(json));
  }
  return array;
}

}  // namespace

DrivenOutput drive(sim::Config& config, const std::filesystem::path& trace, const DrivenChoices& choices,
                   sim::WorkMeter* meter) {
  const std::string name = trace.filename().string();
  const std::vector<Memory> memories = serve_all(config, trace, choices, meter);
  const Memory& best = *std::ranges::min_element(
      memories, {}, [](const Memory& memory) { return memory.served.mean_latency(); });
  const bool one = choices.axes.empty();
  const std::string answer = (one ? "" : best.name() + ": ") + answer_of(best.served);
  const std::string text =
      one ? text_of(best.served, name, choices)
          : trace_line(memories.front().served, name) + "\n" + tables::text_of(memories_table(memories));
  DrivenOutput output;
  output.printed = choices.json
                       ? tables::json_text(one ? json_of(best.served, name) : json_of(memories, name))
                       : "answer        " + answer + "\n\n" + text;
  output.files.report = "A memory by itself\n\n" + text;
  output.files.tables = page_tables(memories, std::array{answer});
  return output;
}

}  // namespace marti::studies::driven
