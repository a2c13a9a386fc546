#include "studies/driven/driven.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "processors/replay/driven_memory.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "studies/driven/request_reader.h"
#include "studies/figures/counted_figures.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/run_result.h"
#include "studies/run/trace/request_format.h"
#include "studies/show/result_parts.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"
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

double mean_of(const memory::WaitStatistics& latency) {
  return latency.count == 0 ? 0.0 : static_cast<double>(latency.sum) / static_cast<double>(latency.count);
}

std::string text_of(const run::RunResult& result, const DrivenResult& driven, const Counted& counted,
                    const RequestReader& trace, const std::string& name, const DrivenChoices& choices) {
  const memory::WaitStatistics& latency = driven.latency;
  const double seconds = static_cast<double>(result.timed.end) / 1e12;
  std::string text = fmt::format(
      "answer        {:.4g} GB/s; a read takes {:.2f} ns, 95 % below {:.2f} ns, the longest {:.2f} ns\n\n",
      seconds > 0.0 ? static_cast<double>(counted.bytes) / seconds / 1e9 : 0.0, mean_of(latency) / nanosecond,
      static_cast<double>(latency.histogram.percentile(late).value_or(0)) / nanosecond,
      static_cast<double>(latency.max) / nanosecond);
  text += fmt::format("trace         {}: {}, {}, {:.1f} MiB, {}, {}\n", name,
                      tables::counted(counted.reads, "read"), tables::counted(counted.writes, "write"),
                      static_cast<double>(counted.bytes) / (1024.0 * 1024.0), trace.form(),
                      trace.timed() ? "each at its time" : "each as soon as there is a place for it");
  text += fmt::format("places        {} reads of a node under way at a time; {} waited for a place\n",
                      choices.outstanding, tables::counted(driven.late, "request"));
  text += fmt::format("time          {}\n", tables::seconds(result.timed.end));
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

ordered_json json_of(const run::RunResult& result, const DrivenResult& driven, const Counted& counted,
                     const RequestReader& trace, const std::string& name) {
  const memory::WaitStatistics& latency = driven.latency;
  ordered_json figures = ordered_json::object();
  figures::for_each_count(figures::counted_figures(), result.counts,
                          [&](const std::string& figure, figures::Count value) {
                            if (is_of_memory(figure)) {
                              figures[figure] = tables::json_of(tables::Cell(value));
                            }
                          });
  figures::for_each_derived({&result.counts}, [&](const std::string& figure, double value) {
    if (is_of_memory(figure)) {
      figures[figure] = value;
    }
  });
  return {{"marti", {{"version", version}}},
          {"trace",
           {{"file", name},
            {"form", trace.form()},
            {"timed", trace.timed()},
            {"reads", counted.reads},
            {"writes", counted.writes},
            {"bytes", counted.bytes}}},
          {"latency",
           {{"mean", mean_of(latency)},
            {"p50", latency.histogram.percentile(median).value_or(0)},
            {"p95", latency.histogram.percentile(late).value_or(0)},
            {"max", latency.max},
            {"waited_for_a_place", driven.late}}},
          {"figures", std::move(figures)}};
}

}  // namespace

std::string drive(sim::Config& config, const std::filesystem::path& trace, const DrivenChoices& choices,
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
  // Banks and caches serve a line at a time, as nodes ask for them; DRAM takes bursts of what it is asked
  // for.
  const bool by_lines = !machine.banks.dram || machine.banks.cache;
  const std::uint32_t line = machine.reference_bytes();
  processors::walk::Request rest;
  rest.bytes = 0;
  const DrivenResult driven =
      processors::replay::drive_memory(machine, options, [&](processors::walk::Request& request) {
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
  const run::RunResult result = as_run(std::move(machine), driven);
  const std::string name = trace.filename().string();
  return choices.json ? tables::json_text(json_of(result, driven, counted, reader, name))
                      : text_of(result, driven, counted, reader, name, choices);
}

}  // namespace marti::studies::driven
