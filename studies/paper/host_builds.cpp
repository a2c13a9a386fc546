#include "studies/paper/host_builds.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "accel/structure.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "sim/finished_parts.h"
#include "studies/host/image_file.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"

namespace marti::studies::paper {

TracedRun trace_run(const PaperConfig& config, const PaperRun& run) {
  TracedRun traced;
  traced.run = run;
  const run::FunctionalRun functional = run::run_functional(config.frame_of(run));
  traced.totals = functional.totals;
  traced.log = functional.frame.log;
  traced.levels = count_levels(traced.log->topology);
  traced.visits = count_visits(*traced.log);
  return traced;
}

namespace {

processors::machine::MachineConfig machine_for(const PaperConfig& config, const InitialLevel& initial) {
  processors::machine::MachineConfig machine = config.machine;
  if (initial.whole) {
    machine.build.sharing = processors::machine::Sharing::none;
    machine.build.initial = processors::machine::InitialTree::full;
  } else {
    machine.build.sharing = processors::machine::Sharing::shared;
    machine.build.initial = processors::machine::InitialTree::level;
    machine.build.level = initial.level;
  }
  return machine;
}

LevelOutcome outcome_of(const processors::replay::MachineResult& result, InitialLevel initial) {
  LevelOutcome outcome;
  outcome.initial = std::move(initial);
  outcome.build = result.build.start_up;
  outcome.render = result.end - result.build.start_up;
  outcome.time = result.time();
  outcome.splits = static_cast<std::uint64_t>(result.build.counts().all_splits());
  const processors::node::BuildLevel all = result.build.all_levels();
  outcome.nodes = static_cast<std::uint64_t>(all.branches + all.leaves + all.partial);
  outcome.partial = static_cast<std::uint64_t>(all.partial);
  outcome.bytes = static_cast<std::uint64_t>(all.node_bytes + all.list_bytes);
  return outcome;
}

}  // namespace

std::vector<RunOutcomes> time_initial_levels(const PaperConfig& config, std::span<const TracedRun> runs) {
  std::vector<RunOutcomes> outcomes(runs.size());
  std::vector<std::pair<std::size_t, std::size_t>> machines;  // run, initial level
  for (std::size_t run = 0; run < runs.size(); ++run) {
    outcomes[run].run = runs[run].run;
    for (InitialLevel& initial : initial_levels(config, runs[run].levels)) {
      machines.emplace_back(run, outcomes[run].levels.size());
      outcomes[run].levels.emplace_back().initial = std::move(initial);
    }
  }
  sim::WorkMeter* const meter = config.frame.meter;
  sim::plan_parts(meter, "machines", machines.size());
  sim::plan_parts(meter, "trees on this computer", config.host_repetitions != 0 ? machines.size() : 0);
  sim::begin_part(meter, "timing initial trees");
  tbb::parallel_for(std::size_t{0}, machines.size(), [&](std::size_t i) {
    const std::size_t run = machines[i].first;
    LevelOutcome& outcome = outcomes[run].levels[machines[i].second];
    sim::once(
        meter, "machines", name_of(outcomes[run].run) + " " + std::to_string(outcome.initial.level),
        [&] {
          outcome =
              outcome_of(processors::replay::replay(*runs[run].log, machine_for(config, outcome.initial)),
                         outcome.initial);
        },
        outcome.build, outcome.render, outcome.time, outcome.splits, outcome.nodes, outcome.partial,
        outcome.bytes);
  });
  return outcomes;
}

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

const accel::LazyOctree& lazy(const accel::Structure& structure) {
  const auto* concrete = dynamic_cast<const accel::StructureOf<accel::LazyOctree>*>(&structure);
  sim::ensure(concrete != nullptr, "not a lazy octree");
  return concrete->concrete();
}

void measure_once(const scenes::Scene& scene, const std::shared_ptr<const accel::TriangleSet>& triangles,
                  const keys::FrameConfig& frame, HostOutcome& outcome) {
  accel::LazyOctreeOptions options;
  options.tree = frame.structure_options.octree;
  options.initial.level = outcome.initial.whole ? 0 : outcome.initial.level;
  const Clock::time_point begin = Clock::now();
  const std::unique_ptr<accel::Structure> structure = accel::make_lazy_octree(triangles, options);
  outcome.build_seconds = std::min(outcome.build_seconds, seconds_since(begin));
  const Clock::time_point built = Clock::now();
  static_cast<void>(processors::program::render(scene, *triangles, *structure, frame.render));
  outcome.render_seconds = std::min(outcome.render_seconds, seconds_since(built));
  const accel::LazyOctreeState state = lazy(*structure).state();
  outcome.nodes = state.all.nodes();
  outcome.partial = state.all.pending;
  outcome.bytes = state.node_bytes + state.list_bytes;
}

}  // namespace

std::vector<HostOutcome> measure_host(const PaperConfig& config, const TracedRun& run) {
  const keys::FrameConfig frame = config.frame_of(run.run);
  const scenes::Scene scene = run::open_frame(frame);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  std::vector<HostOutcome> outcomes;
  for (InitialLevel& initial : initial_levels(config, run.levels)) {
    HostOutcome& outcome = outcomes.emplace_back();
    outcome.initial = std::move(initial);
    outcome.build_seconds = std::numeric_limits<double>::infinity();
    outcome.render_seconds = std::numeric_limits<double>::infinity();
    sim::once(
        config.frame.meter, "trees on this computer",
        name_of(run.run) + " " + std::to_string(outcome.initial.level),
        [&] {
          for (std::uint32_t repetition = 0; repetition < config.host_repetitions; ++repetition) {
            measure_once(scene, triangles, frame, outcome);
          }
        },
        outcome.build_seconds, outcome.render_seconds, outcome.nodes, outcome.partial, outcome.bytes);
  }
  return outcomes;
}

tables::Table host_building_table(std::size_t index, const PaperRun& run,
                                  std::span<const HostOutcome> outcomes) {
  tables::Table table(
      fmt::format("host_table{}", index + 2),
      fmt::format("Table {} on the host: {}", index + 2, name_of(run)),
      {tables::count_column("level", "initial level: its nodes are not divided before the frame"),
       tables::text_column("note", "rules that choose the level"),
       tables::real_column("build", "s", "building to the initial level"),
       tables::real_column("render", "s", "the frame, building on demand included"),
       tables::real_column("total", "s", "both"),
       tables::count_column("nodes", "nodes that the frame leaves"),
       tables::count_column("partial", "of these, nodes left partially built"),
       tables::integer_column("memory", "byte", "host memory of nodes and lists")});
  for (const HostOutcome& outcome : outcomes) {
    table.add_row({outcome.initial.level, outcome.initial.note(), outcome.build_seconds,
                   outcome.render_seconds, outcome.build_seconds + outcome.render_seconds, outcome.nodes,
                   outcome.partial, outcome.bytes});
  }
  return table;
}

}  // namespace marti::studies::paper
