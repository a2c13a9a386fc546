#include "studies/frames/frame_ways.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "studies/frames/frame_sequence.h"

namespace marti::studies::frames {

namespace {

WayOutcome outcome_of(const processors::replay::MachineResult& result) {
  WayOutcome outcome;
  outcome.build = result.build.start_up;
  outcome.render = result.end - result.build.start_up;
  outcome.building =
      sim::ticks_of(result.time()[static_cast<std::size_t>(processors::cost::Activity::building)]);
  const processors::node::BuildLevel all = result.build.all_levels();
  outcome.start_up_splits = all.start_up_splits;
  outcome.splits = all.splits;
  outcome.branches = all.branches;
  outcome.partial = all.partial;
  outcome.bytes = all.node_bytes + all.list_bytes;
  return outcome;
}

}  // namespace

WayOutcomes FrameWays::time(const processors::program::WorkLog& log, const accel::OctreeUpdate* update) {
  std::array<processors::replay::ReplayOptions, frame_ways> options;
  if (update != nullptr) {
    options[static_cast<std::size_t>(FrameWay::partial)].starts = partial_starts(*update);
    options[static_cast<std::size_t>(FrameWay::partial_dynamic)].starts = carried_starts(*update, built_);
  }
  options[static_cast<std::size_t>(FrameWay::partial_dynamic)].report_built = true;
  WayOutcomes outcomes;
  std::vector<std::uint8_t> built;
  tbb::parallel_for(std::size_t{0}, frame_ways, [&](std::size_t i) {
    const auto way = static_cast<FrameWay>(i);
    processors::machine::MachineConfig machine = machine_;
    if (way == FrameWay::rebuild_all || way == FrameWay::partial) {
      machine.build = {};
      machine.build.sharing = processors::machine::Sharing::none;
    }
    processors::replay::MachineResult result = processors::replay::replay(log, machine, options[i]);
    outcomes[i] = outcome_of(result);
    if (way == FrameWay::partial_dynamic) {
      built = std::move(result.build.built);
    }
  });
  built_ = std::move(built);
  return outcomes;
}

}  // namespace marti::studies::frames
