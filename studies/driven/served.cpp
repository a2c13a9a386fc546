#include "studies/driven/served.h"

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "sim/key_error.h"
#include "studies/driven/request_reader.h"
#include "studies/figures/counted_figures.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/trace/request_format.h"

namespace marti::studies::driven {

namespace {

using processors::replay::DrivenResult;

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
  result.counts = figures::counts_of(result.machine, result.timed);
  return result;
}

}  // namespace

double Served::bytes_a_second() const {
  return result.timed.end == 0 ? 0.0
                               : static_cast<double>(bytes) * static_cast<double>(sim::ticks_per_second) /
                                     static_cast<double>(result.timed.end);
}

double Served::mean_latency() const {
  const memory::WaitStatistics& of = driven.latency;
  return of.count == 0 ? 0.0 : static_cast<double>(of.sum) / static_cast<double>(of.count);
}

double Served::hit_ratio() const {
  const auto hits = static_cast<double>(driven.references.all_hits());
  const auto all = hits + static_cast<double>(driven.references.all_misses());
  return all == 0.0 ? 0.0 : hits / all;
}

std::int64_t Served::latency(double percent) const {
  return driven.latency.histogram.percentile(percent).value_or(0);
}

double Served::picojoules_a_byte() const {
  constexpr double femtojoules = 1e3;
  return result.timed.energy && bytes > 0
             ? static_cast<double>(result.timed.energy->total) / femtojoules / static_cast<double>(bytes)
             : 0.0;
}

Served serve(sim::Config& config, const std::filesystem::path& trace, const DrivenChoices& choices,
             sim::WorkMeter* meter) {
  // Keys of the frame and of what is recorded are read, so that a configuration of `marti run` is no error.
  (void)keys::read_frame(config);
  processors::machine::MachineConfig machine = keys::read_machine(config);
  (void)keys::read_record(config, true);
  config.refuse_unused();
  machine.count = {};
  if (machine.clusters > 1) {
    throw sim::KeyError("machine.clusters", "a trace drives the memory of one cluster");
  }
  TraceDefaults defaults;
  defaults.nodes = machine.nodes;
  defaults.addresses = addresses_of(machine);
  defaults.cycle = run::cycle_of(machine);
  defaults.bytes = run::burst_of(machine);
  RequestReader reader(trace, defaults);
  Served served;
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
        ++(request.write ? served.writes : served.reads);
        served.bytes += request.bytes;
        return true;
      });
  if (served.reads + served.writes == 0) {
    throw sim::UserError(trace.string() + ": has no requests");
  }
  served.result = as_run(std::move(machine), driven);
  served.result.values = config.effective_values();
  served.driven = std::move(driven);
  served.form = reader.form();
  served.timed = reader.timed();
  return served;
}

}  // namespace marti::studies::driven
