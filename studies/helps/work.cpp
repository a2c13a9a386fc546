#include "studies/helps/work.h"

namespace marti::studies::helps {

using processors::cost::Activity;

sim::Ticks least_time(const processors::machine::MachineConfig& machine,
                      const processors::replay::MachineResult& result,
                      const processors::machine::MachineConfig& changed) {
  if (machine.kind == processors::machine::NodeKind::simt) {
    return 0;  // lanes take steps together, and how many do depends on the machine
  }
  const processors::cost::TimeSums time = result.time();
  sim::Sum steps = 0;
  for (const Activity activity : {Activity::traversal, Activity::intersection, Activity::shading}) {
    steps += time[static_cast<std::size_t>(activity)];
  }
  const sim::Sum cycles = steps / machine.clock.period();
  const std::int64_t nodes = changed.all_nodes();
  // Whole cycles of each node, so that the product cannot overflow where the frame itself has not.
  return changed.clock.cycles(sim::ticks_of(cycles / nodes)) +
         changed.clock.cycles(static_cast<std::int64_t>(cycles % nodes)) / nodes;
}

namespace {

// Found by timing (docs/internals/benchmarks.md); docs/internals/model.md has the table.
constexpr Work traced_step = 8;
constexpr Work walked_reference = 4;
constexpr Work stripped_reference = 10;
constexpr Work stripping_of_a_reference = 4;
constexpr Work event = 80;
constexpr Work event_of_lanes = 240;  // a cycle of a SIMT node, or a line that it asks for

Work references_of(const processors::replay::MachineResult& result) {
  return static_cast<Work>(result.references().references());
}

}  // namespace

Work whole_replay_work(Work references, Work events) {
  return walked_reference * references + event * events;
}

Work replay_work(const processors::replay::MachineResult& result,
                 const processors::walk::StrippedLog* stripped) {
  if (!result.simt.nodes.empty()) {
    return event_of_lanes * result.events;
  }
  return stripped != nullptr ? stripped_reference * stripped->references() + event * result.events
                             : whole_replay_work(references_of(result), result.events);
}

Work run_work(const processors::program::LogTotals& totals, const processors::replay::MachineResult& machine,
              const processors::replay::MachineResult& one_node,
              const processors::walk::StrippedLog* stripped) {
  const Work stripping = stripped != nullptr ? stripping_of_a_reference * references_of(machine) : 0;
  return traced_step * totals.all_steps() + stripping + replay_work(machine, stripped) +
         replay_work(one_node, stripped);
}

}  // namespace marti::studies::helps
