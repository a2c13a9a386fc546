#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "processors/machine/packets.h"
#include "processors/path/path_recorder.h"
#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/config_errors.h"
#include "studies/host/image_file.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/other_commands.h"
#include "studies/keys/record_keys.h"
#include "studies/run/expected_times.h"
#include "studies/run/plan/machine_plan.h"
#include "studies/run/record/interval_figures.h"
#include "studies/run/record/observers.h"
#include "studies/run/run_result.h"

namespace marti::studies::run {

void refuse_beyond_memory(const sim::Config& config, const keys::FrameConfig& frame,
                          const processors::machine::MachineConfig& machine) {
  if (const std::string excess = frame.memory.excess(
          processors::replay::host_bytes(machine, frame.render.width, frame.render.height));
      !excess.empty()) {
    config.fail("machine.nodes", "simulating these nodes and their caches takes" + excess);
  }
}

void refuse_several_frames(const sim::Config& config, const keys::FrameRange& frames) {
  if (frames.count > 1) {
    config.fail("frames.count", std::to_string(frames.count) +
                                    " frames are asked for, but `marti run` renders one, that of "
                                    "frames.first; set frames.count = 1, or "
                                    "use `marti study frames`");
  }
}

namespace {

// Declares the sections of a sweep as free: most commands for a single machine ignore what they hold.
void declare_sweep_sections(sim::Schema& schema) {
  schema.free_section(
      "sweep",
      "only for `marti sweep`, which times many machines: [sweep.axes], [[sweep.zip]], [sweep.points.NAME], "
      "[sweep.base] and [sweep.compare] say which (docs/sweep.md)");
  schema.free_section("question",
                      "only for `marti sweep`: what its machines are timed for, and SQL queries over its "
                      "points that answer it "
                      "(docs/sweep.md)");
  schema.free_section("prices",
                      "what a machine costs, in units of your own: for `marti sweep`, and for what `marti "
                      "run` says would help");
}

std::uint64_t map_bytes(const keys::FrameConfig& frame) {
  return HeatMap::host_bytes(std::uint64_t{frame.render.width} * frame.render.height);
}

void refuse_maps_beyond_memory(const sim::Config& config, const keys::RecordConfig& record,
                               const keys::FrameConfig& frame) {
  const std::string excess = frame.memory.excess(map_bytes(frame));
  if (record.heat_maps && !excess.empty()) {
    config.fail("record.heat_maps", "maps of this image take" + excess);
  }
}

std::uint64_t packets_of(const processors::program::WorkLog& log,
                         const processors::machine::MachineConfig& machine) {
  return processors::machine::packets_of_image(log.width, log.height, machine.packets);
}

// Refuses what can be told only when the frame is known.
void refuse_beyond_memory(const RunResult& result) {
  const std::uint64_t machine = processors::replay::host_bytes(*result.functional.frame.log, result.machine);
  const std::uint64_t working_set = processors::passes::working_set_bytes(result.machine);
  result.frame_config.memory.require(std::max(machine, working_set),
                                     "simulating these nodes, with what they count, takes",
                                     "simulate fewer nodes (machine.nodes) or count less ([count])");
}

std::uint64_t bytes_of(const processors::walk::StrippedLog* stripped) {
  return stripped == nullptr ? 0 : stripped->bytes_of_words();
}

// The memory that is left beside the work logs, the machine and heat maps.
sim::MemoryBudget memory_beside(const RunResult& result, const keys::RecordConfig& record,
                                const processors::walk::StrippedLog* stripped) {
  sim::MemoryBudget budget = result.frame_config.memory;
  budget.take(result.functional.totals.bytes + bytes_of(stripped) +
                  processors::replay::host_bytes(*result.functional.frame.log, result.machine) +
                  (record.heat_maps ? map_bytes(result.frame_config) : 0),
              "the work log and the machine take", "make the image smaller");
  return budget;
}

// Times the machine with the observers that are asked for, then evaluates what they have seen.
processors::replay::MachineResult watched_replay(const keys::RecordConfig& record, const RunOptions& run,
                                                 const processors::walk::StrippedLog* stripped,
                                                 RunResult& result) {
  Observers observers;
  std::optional<processors::path::PathRecorder> path;
  if (record.critical_path) {
    // A timeline shows the pieces of the path; else only their sums are wanted.
    observers.add(path.emplace(
        memory_beside(result, record, stripped),
        record.timeline ? processors::path::PathPieces::no_fold : processors::path::PathPieces::usual_fold));
  }
  if (record.timeline) {
    result.timeline = std::make_unique<Timeline>(run.directory / "timeline.json", record.timeline_options);
    result.timeline->mark(path ? &*path : nullptr);
    observers.add(*result.timeline);
  }
  if (record.heat_maps) {
    result.heat_map = std::make_unique<HeatMap>();
    observers.add(*result.heat_map);
  }
  processors::walk::PacketsOfNodes packets_of_nodes;
  if (result.machine.count.working_set) {
    observers.add(packets_of_nodes);
  }
  std::optional<IntervalFigures> intervals;
  if (record.interval > 0) {
    observers.add(intervals.emplace(result.machine, record.interval));
  }
  processors::replay::ReplayOptions options;
  options.observer = observers.empty() ? nullptr : &observers;
  options.intervals = intervals ? &intervals->asked() : nullptr;
  options.stripped = path || intervals ? nullptr : stripped;  // both need every step in its place
  options.path = path ? &*path : nullptr;
  options.meter = run.meter;
  options.threads = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
  const KeptItems& kept = result.frame_config.keep;
  keep(kept, options);
  const processors::program::WorkLog& log = *result.functional.frame.log;
  std::vector<PlanEntry> entries = machine_plan(kept, result.machine, log, options.observer != nullptr);
  processors::replay::MachineResult timed = processors::replay::replay(log, result.machine, options);
  add_entries(result.plan, std::move(entries));
  if (path) {
    result.critical_path = path->path();
  }
  if (intervals) {
    result.intervals = intervals->table(figures::counts_of(result.machine, timed));
  }
  if (result.machine.count.working_set) {
    const std::uint64_t a_thread = processors::passes::working_set_bytes(result.machine);
    const std::uint64_t threads = result.frame_config.memory.left() / std::max<std::uint64_t>(a_thread, 1);
    result.working_set = processors::passes::working_set(
        packets_of_nodes,
        static_cast<unsigned>(std::clamp<std::uint64_t>(
            threads, 1, static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency()))));
    processors::passes::check_working_set(*result.working_set, result.machine, timed);
  }
  return timed;
}

// Stripping takes less time than the two machines save, but not where little is taken out.
bool strips_for_both(const processors::machine::MachineConfig& machine,
                     const processors::machine::MachineConfig& other) {
  using processors::walk::StrippedLog;
  return StrippedLog::ways_of(machine) != 0 && !StrippedLog::key_of(machine).empty() &&
         StrippedLog::ways_of(machine) == StrippedLog::ways_of(other) &&
         StrippedLog::key_of(machine) == StrippedLog::key_of(other);
}

// The log stripped for `machine` and `other`, which both walk it; null where that would not be faster or
// would take more than half of the memory that the work log, the machine and heat maps leave.
std::shared_ptr<const processors::walk::StrippedLog> strip_for_both(
    const keys::FrameConfig& frame, const processors::program::WorkLog& log, std::uint64_t log_bytes,
    const processors::machine::MachineConfig& machine, const processors::machine::MachineConfig& other,
    const RunOptions& options) {
  using processors::walk::StrippedLog;
  if (!strips_for_both(machine, other)) {
    return nullptr;
  }
  const std::uint64_t taken = log_bytes + processors::replay::host_bytes(log, machine) + map_bytes(frame);
  const std::uint64_t left = frame.memory.left();
  if (taken >= left) {
    return nullptr;
  }
  KeptStrippedLogs* const kept = options.stripped_logs;
  std::shared_ptr<const StrippedLog> stripped = kept == nullptr ? nullptr : kept->find(machine);
  if (stripped == nullptr) {
    sim::begin_part(options.meter, "taking known references out", "packets", packets_of(log, machine));
    stripped = StrippedLog::make(log, machine, (left - taken) / 2, options.meter);
    if (kept != nullptr && stripped != nullptr && stripped->bytes_of_words() <= (left - taken) / 4) {
      kept->keep(stripped);
    }
  }
  return stripped;
}

// What is told while the machine and one node are timed. Only of a machine that takes long it is said why one
// thread times it.
std::string timing_of(const processors::machine::MachineConfig& machine) {
  const std::uint32_t many_nodes = processors::replay::ReplayOptions().fewest_nodes_of_threads;
  const char* const why = processors::replay::why_one_thread(machine, many_nodes);
  return "timing the machine and one node" + (machine.all_nodes() < many_nodes || why == nullptr
                                                  ? std::string()
                                                  : std::string(", each on one thread, because ") + why);
}

// Times the frame on the machine and on one node, at the same time, and derives all other figures. Returns
// the stripped log of both machines, if they had one.
std::shared_ptr<const processors::walk::StrippedLog> time_frame(const keys::RecordConfig& record,
                                                                const RunOptions& options,
                                                                RunResult& result) {
  std::shared_ptr<const processors::walk::StrippedLog> stripped;
  result.plan = result.functional.plan;
  const processors::program::WorkLog& log = *result.functional.frame.log;
  refuse_beyond_memory(result);
  if (result.machine.all_nodes() == 1) {
    sim::begin_part(options.meter, "timing the machine", "packets", packets_of(log, result.machine));
    result.timed = watched_replay(record, options, nullptr, result);
    result.one_node = result.timed;
  } else {
    const processors::machine::MachineConfig one_node = processors::machine::one_node_of(result.machine);
    stripped = strip_for_both(result.frame_config, log, result.functional.totals.bytes, result.machine,
                              one_node, options);
    sim::begin_part(options.meter, timing_of(result.machine), "packets",
                    packets_of(log, result.machine) + packets_of(log, one_node));
    processors::replay::ReplayOptions of_one;
    of_one.meter = options.meter;
    keep(result.frame_config.keep, of_one);
    of_one.stripped = stripped.get();
    // What is wrong with the machine is told first, whichever is done first.
    std::exception_ptr fault;
    tbb::parallel_invoke([&] { result.timed = watched_replay(record, options, stripped.get(), result); },
                         [&] {
                           try {
                             result.one_node = processors::replay::replay(log, one_node, of_one);
                           } catch (...) {
                             fault = std::current_exception();
                           }
                         });
    if (fault != nullptr) {
      std::rethrow_exception(fault);
    }
  }
  result.counts = figures::counts_of(result.machine, result.timed);
  result.one_node_counts =
      figures::counts_of(processors::machine::one_node_of(result.machine), result.one_node);
  result.bounds = processors::replay::frame_bounds(result.machine, result.timed);
  result.prediction = processors::replay::predict(result.machine, result.timed);
  return stripped;
}

// The work log is in memory already, the stripped one too.
helps::WhatHelps measure_help(const sim::Config& config, const RunOptions& run,
                              std::shared_ptr<const processors::walk::StrippedLog> stripped,
                              const RunResult& result) {
  constexpr helps::Work least_budget = 2'000'000'000;  // two seconds
  const helps::Work budget =
      run.what_helps == helps::Measuring::all
          ? helps::unlimited_work
          : std::max(least_budget, helps::run_work(result.functional.totals, result.timed, result.one_node,
                                                   stripped.get()));
  helps::SharedLog shared{
      *result.functional.frame.log, std::move(stripped), {}, result.frame_config.memory, run.meter};
  keep(result.frame_config.keep, shared.options);
  const std::uint64_t taken = result.functional.totals.bytes + bytes_of(shared.stripped.get());
  shared.memory = sim::MemoryBudget(shared.memory.left() - std::min(taken, shared.memory.left()));
  return helps::what_helps(config, run.prices, result.machine, result.timed, shared, budget);
}

// The options of another run of `first`.
RunOptions options_like(const RunResult& first) {
  RunOptions options;
  options.meter = first.frame_config.meter;
  return options;
}

// A result with the configuration of `first`, for which nothing has been run yet.
RunResult described_by(const RunResult& first, const KeptItems& keep) {
  RunResult result;
  result.config_name = first.config_name;
  result.frame_config = first.frame_config;
  result.frame_config.keep = keep;
  result.machine = first.machine;
  result.values = first.values;
  return result;
}

}  // namespace

sim::Schema run_schema() {
  sim::Schema schema;
  keys::declare_frame_keys(schema);
  keys::declare_machine_keys(schema);
  keys::declare_record_keys(schema);
  declare_sweep_sections(schema);
  keys::declare_sections_of_other_commands(schema);
  return schema;
}

RunResult run(sim::Config& config, RunOptions options) {
  RunResult result;
  result.config_name = config.name();
  result.frame_config = keys::read_frame(config);
  result.frame_config.keep = options.keep;
  result.frame_config.wait_with(options.meter);
  result.frame_config.render.hits =
      result.frame_config.render.integrator == processors::program::Integrator::rays;
  refuse_several_frames(config, result.frame_config.frames);
  result.machine = keys::read_machine(config);
  const keys::RecordConfig record = keys::read_record(config, !options.directory.empty());
  config.refuse_unused();
  refuse_beyond_memory(config, result.frame_config, result.machine);
  refuse_maps_beyond_memory(config, record, result.frame_config);
  if (record.critical_path) {
    sim::with_places(config, [&] { processors::path::check_critical_path(result.machine); });
  }
  result.values = config.effective_values();
  std::optional<ExpectedTimes> expected;
  if (options.foreseen != nullptr && !options.functional && result.frame_config.log == nullptr) {
    result.frame_config.expected = &expected.emplace(*options.foreseen);
    const bool strips = result.machine.all_nodes() > 1 &&
                        strips_for_both(result.machine, processors::machine::one_node_of(result.machine));
    expected->begin(result.frame_config, result.machine, strips,
                    options.what_helps != helps::Measuring::none);
  }
  sim::with_places(config, [&] {
    result.functional =
        options.functional ? std::move(*options.functional) : run_functional(result.frame_config);
    if (!options.directory.empty()) {
      host::load_image_library();  // before the machine is timed, which may take long
    }
    std::shared_ptr<const processors::walk::StrippedLog> stripped = time_frame(record, options, result);
    if (expected) {
      expected->timed();
    }
    if (options.what_helps != helps::Measuring::none) {
      result.helps = measure_help(config, options, std::move(stripped), result);
    }
  });
  result.frame_config.expected = nullptr;
  return result;
}

RunResult run_again(const RunResult& first, const KeptItems& keep) {
  RunResult result = described_by(first, keep);
  result.functional = run_functional(result.frame_config);
  (void)time_frame({}, options_like(first), result);
  return result;
}

}  // namespace marti::studies::run
