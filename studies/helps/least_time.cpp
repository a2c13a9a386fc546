#include "studies/helps/least_time.h"

namespace marti::studies::helps {

using processors::cost::Activity;

sim::Ticks least_time(const processors::machine::MachineConfig& machine,
                      const processors::replay::MachineResult& result,
                      const processors::machine::MachineConfig& changed) {
  const processors::cost::TimeDivision time = result.time();
  sim::Ticks steps = 0;
  for (const Activity activity : {Activity::traversal, Activity::intersection, Activity::shading}) {
    steps = sim::add_ticks(steps, time[static_cast<std::size_t>(activity)]);
  }
  const std::int64_t cycles = steps / machine.clock.period();
  const std::int64_t nodes = changed.all_nodes();
  // Whole cycles of each node, so that the product cannot overflow where the frame itself has not.
  return changed.clock.cycles(cycles / nodes) + changed.clock.cycles(cycles % nodes) / nodes;
}

}  // namespace marti::studies::helps
