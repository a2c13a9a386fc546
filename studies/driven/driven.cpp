#include "studies/driven/driven.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "processors/replay/driven_memory.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "studies/driven/request_reader.h"
#include "studies/figures/counted_figures.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/keys/setting_value.h"
#include "studies/run/run_result.h"
#include "studies/run/trace/request_format.h"
#include "studies/show/result_parts.h"
#include "studies/sweep/plan/axis_values.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"
#include "studies/tables/table.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"
#include "studies/version.h"

namespace marti::studies::driven {

namespace {

using nlohmann::ordered_json;
using processors::replay::DrivenResult;

constexpr double nanosecond = 1e3;  // in ps
constexpr double median = 50.0;
constexpr double late = 95.0;

struct Counted {
  std::int64_t reads = 0;
  std::int64_t writes = 0;
  std::int64_t bytes = 0;
};

// What one configuration has served.
struct Served {
  run::RunResult result;
  DrivenResult driven;
  Counted counted;
  std::string_view form;
  bool timed = false;

  [[nodiscard]] double bytes_a_second() const {
    return result.timed.end == 0
               ? 0.0
               : static_cast<double>(counted.bytes) * static_cast<double>(sim::ticks_per_second) /
                     static_cast<double>(result.timed.end);
  }
  [[nodiscard]] double mean_latency() const {
    const memory::WaitStatistics& of = driven.latency;
    return of.count == 0 ? 0.0 : static_cast<double>(of.sum) / static_cast<double>(of.count);
  }
  [[nodiscard]] double hit_ratio() const {
    const auto hits = static_cast<double>(driven.references.all_hits());
    const auto all = hits + static_cast<double>(driven.references.all_misses());
    return all == 0.0 ? 0.0 : hits / all;
  }
  [[nodiscard]] std::int64_t latency(double percent) const {
    return driven.latency.histogram.percentile(percent).value_or(0);
  }
};

// Figures of the parts that the memory has; those of nodes, which there are none of, are left out.
bool is_of_memory(std::string_view name) {
  for (const std::string_view part : {"interconnect_", "bank_", "dram_", "l2_"}) {
    if (name.starts_with(part)) {
      return true;
    }
  }
  return name == "end";
}

// Bytes that can be told apart: of DRAM all that it has, and as many lines as a shared cache can name.
std::uint64_t addresses_of(const processors::machine::MachineConfig& machine) {
  std::uint64_t bytes = TraceDefaults().addresses;
  if (machine.banks.cache) {
    bytes = std::min(bytes, std::uint64_t{machine.reference_bytes()} << 32U);
  }
  if (const auto& dram = machine.banks.dram) {
    bytes = std::min(bytes, dram->capacity());
  }
  return bytes;
}

// A result whose parts are shown as those of a run.
run::RunResult as_run(processors::machine::MachineConfig machine, const DrivenResult& driven) {
  run::RunResult result;
  result.machine = std::move(machine);
  result.timed = driven.machine;
  result.totals = figures::totals_of(result.timed);
  result.counts = figures::counts_of(result.machine, result.timed, result.totals);
  return result;
}

constexpr double giga = 1e9;

std::string answer_of(const Served& served) {
  return fmt::format("{:.4g} GB/s; a read takes {:.2f} ns, 95 % below {:.2f} ns, the longest {:.2f} ns",
                     served.bytes_a_second() / giga, served.mean_latency() / nanosecond,
                     static_cast<double>(served.latency(late)) / nanosecond,
                     static_cast<double>(served.driven.latency.max) / nanosecond);
}

std::string trace_line(const Served& served, const std::string& name) {
  return fmt::format("trace         {}: {}, {}, {}, {}, {}\n", name,
                     tables::counted(served.counted.reads, "read"),
                     tables::counted(served.counted.writes, "write"),
                     tables::bytes(static_cast<double>(served.counted.bytes)), served.form,
                     served.timed ? "each at its time" : "each as soon as there is a place for it");
}

std::string text_of(const Served& served, const std::string& name, const DrivenChoices& choices) {
  const run::RunResult& result = served.result;
  std::string text = "answer        " + answer_of(served) + "\n\n" + trace_line(served, name);
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
  return text;
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
                         {"reads", served.counted.reads},
                         {"writes", served.counted.writes},
                         {"bytes", served.counted.bytes}}},
                       {"latency",
                        {{"mean", served.mean_latency()},
                         {"p50", served.latency(median)},
                         {"p95", served.latency(late)},
                         {"max", served.driven.latency.max},
                         {"waited_for_a_place", served.driven.late}}},
                       {"figures", std::move(figures)}};
  if (references.all_hits() + references.all_misses() > 0) {
    json["caches"] = {{"hits", references.all_hits()}, {"misses", references.all_misses()}};
  }
  return json;
}

Served serve(sim::Config& config, const std::filesystem::path& trace, const DrivenChoices& choices,
             sim::WorkMeter* meter) {
  // Keys of the frame and of what is recorded are read, so that a configuration of `marti run` is no error.
  (void)keys::read_frame(config);
  processors::machine::MachineConfig machine = keys::read_machine(config);
  (void)keys::read_record(config, true);
  config.refuse_unused();
  machine.count = {};
  machine.energy = {};
  if (machine.clusters > 1) {
    throw sim::KeyError("machine.clusters", "a trace drives the memory of one cluster");
  }
  TraceDefaults defaults;
  defaults.nodes = machine.nodes;
  defaults.addresses = addresses_of(machine);
  defaults.cycle = run::cycle_of(machine);
  defaults.bytes = run::burst_of(machine);
  RequestReader reader(trace, defaults);
  Counted counted;
  processors::replay::DrivenOptions options;
  options.outstanding = choices.outstanding;
  options.timed = reader.timed();
  options.meter = meter;
  options.caches = choices.caches;
  if (choices.caches && machine.cache.organisation == processors::machine::CacheOrganisation::split &&
      !reader.has_kinds()) {
    throw sim::KeyError(
        "cache.organisation",
        "\"split\" needs a trace that says what kind of record each request is of: CSV with the "
        "column kind");
  }
  // Banks and caches serve a line at a time, as nodes ask for them; DRAM takes bursts of what it is asked
  // for.
  const bool by_lines = choices.caches || !machine.banks.dram || machine.banks.cache;
  const std::uint32_t line = machine.reference_bytes();
  processors::replay::DrivenRequest rest;
  rest.bytes = 0;
  DrivenResult driven =
      processors::replay::drive_memory(machine, options, [&](processors::replay::DrivenRequest& request) {
        if (rest.bytes == 0 && !reader.next(rest)) {
          return false;
        }
        request = rest;
        if (by_lines && (!rest.write || rest.bytes > line)) {
          const auto left = static_cast<std::uint32_t>(line - rest.address % line);
          request.bytes = std::min(rest.bytes, left);
        }
        rest.address += request.bytes;
        rest.bytes -= request.bytes;
        ++(request.write ? counted.writes : counted.reads);
        counted.bytes += request.bytes;
        return true;
      });
  if (counted.reads + counted.writes == 0) {
    throw sim::UserError(trace.string() + ": has no requests");
  }
  run::RunResult result = as_run(std::move(machine), driven);
  return {std::move(result), std::move(driven), counted, reader.form(), reader.timed()};
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

tables::Table table_of(const sim::Schema& schema, const std::vector<std::vector<sim::Setting>>& points,
                       const std::vector<Served>& all, const DrivenChoices& choices) {
  std::vector<tables::Column> columns;
  for (const sim::Setting& setting : points.front()) {
    columns.push_back(tables::text_column(schema.keys()[setting.key].name, "a setting"));
  }
  columns.push_back(tables::real_column("bandwidth", "GB/s", "what was asked for in the time it took"));
  columns.push_back(tables::real_column("latency", "ns", "of reads, mean"));
  columns.push_back(tables::real_column("latency_95", "ns", "of 95 % of the reads at most"));
  columns.push_back(tables::real_column("latency_max", "ns", "of a read at most"));
  columns.push_back(tables::real_column("end", "us", "when the last request was served"));
  if (choices.caches) {
    columns.push_back(tables::real_column("hit_ratio", "fraction", "hits of the private caches"));
  }
  columns.push_back(tables::real_column("dram_row_hit_ratio", "fraction", "bursts that find their row open"));
  tables::Table table("memories", "A trace served by each memory", std::move(columns));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Served& served = all[i];
    std::vector<tables::Cell> row;
    for (const sim::Setting& setting : points[i]) {
      row.emplace_back(shown_setting(schema, setting));
    }
    const auto in_nanoseconds = [](sim::Ticks time) { return static_cast<double>(time) / nanosecond; };
    row.insert(row.end(), {served.bytes_a_second() / giga, served.mean_latency() / nanosecond,
                           in_nanoseconds(served.latency(late)), in_nanoseconds(served.driven.latency.max),
                           in_nanoseconds(served.result.timed.end) / 1e3});
    if (choices.caches) {
      row.emplace_back(served.hit_ratio());
    }
    const std::optional<double> rows = served.result.figure("dram_row_hit_ratio");
    row.push_back(rows ? tables::Cell(*rows) : tables::Cell());
    table.add_row(std::move(row));
  }
  return table;
}

}  // namespace

std::string drive(sim::Config& config, const std::filesystem::path& trace, const DrivenChoices& choices,
                  sim::WorkMeter* meter) {
  const std::string name = trace.filename().string();
  if (choices.axes.empty()) {
    const Served served = serve(config, trace, choices, meter);
    return choices.json ? tables::json_text(json_of(served, name)) : text_of(served, name, choices);
  }
  if (!std::filesystem::is_regular_file(trace)) {
    throw sim::UserError(trace.string() +
                         ": is no file, and with --axis the trace is read again for each value");
  }
  const std::vector<std::vector<sim::Setting>> points = settings_of(config, choices.axes);
  std::vector<Served> all;
  for (const std::vector<sim::Setting>& point : points) {
    sim::Config of_point = config.with(point);
    all.push_back(sim::with_places(of_point, [&] { return serve(of_point, trace, choices, meter); }));
  }
  if (choices.json) {
    ordered_json array = ordered_json::array();
    for (std::size_t i = 0; i < all.size(); ++i) {
      ordered_json json = {{"settings", ordered_json::object()}};
      for (const sim::Setting& setting : points[i]) {
        json["settings"][config.schema().keys()[setting.key].name] = shown_setting(config.schema(), setting);
      }
      json.update(json_of(all[i], name));
      array.push_back(std::move(json));
    }
    return tables::json_text(array);
  }
  const auto least = std::ranges::min_element(all, {}, &Served::mean_latency);
  std::string best;
  for (const sim::Setting& setting : points[static_cast<std::size_t>(least - all.begin())]) {
    best += (best.empty() ? "" : ", ") + config.schema().keys()[setting.key].name + " = " +
            shown_setting(config.schema(), setting);
  }
  return "answer        " + best + ": " + answer_of(*least) + "\n\n" + trace_line(all.front(), name) + "\n" +
         tables::text_of(table_of(config.schema(), points, all, choices));
}

}  // namespace marti::studies::driven
