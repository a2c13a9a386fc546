#include "studies/paper/build_times.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "processors/replay/replay.h"

namespace marti::studies::paper {

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
  sim::begin_part(config.frame.meter, "timing initial trees", "machines", machines.size());
  tbb::parallel_for(std::size_t{0}, machines.size(), [&](std::size_t i) {
    const auto [run, level] = machines[i];
    LevelOutcome& outcome = outcomes[run].levels[level];
    outcome = outcome_of(processors::replay::replay(*runs[run].log, machine_for(config, outcome.initial)),
                         outcome.initial);
    sim::count_step(config.frame.meter);
  });
  return outcomes;
}

}  // namespace marti::studies::paper
