// Traversal stacks of which a lane has so many entries on chip, and the others in memory
// (docs/internals/rt-unit.md, Stacks in memory).
#include <algorithm>

#include "processors/simt/simt_node.h"

namespace marti::processors::simt {

// Once move_stack() has popped entries that are in memory: the lane wants the next of their lines, or, when
// it has read them all, the first record of the visit that they were popped for. False: it has nothing to
// read and no such visit.
bool SimtNode::read_stack(std::uint32_t warp, std::uint32_t number) {
  SpilledStack& its = spilled_stack(warp, number);
  if (its.to_read > 0) {
    --its.to_read;
    lane(warp, number).record = {stack_line(warp, number, its.stack.lines() + its.to_read),
                                 shared_.input.config.reference_bytes(), memory::RecordKind::node,
                                 Test::none};
    return true;
  }
  if (its.goes_on) {
    its.goes_on = false;
    lane(warp, number).record = its.record;
    follow(warp, number, its.visit);
    return true;
  }
  return false;
}

// A lane's visit is over: what it has pushed may fill lines, which are written. It goes on with another
// visit, whose first record it would want, or none (null). True: it wants a line of its stack before.
bool SimtNode::move_stack(std::uint32_t warp, std::uint32_t number, const std::uint32_t* visit) {
  SpilledStack& its = spilled_stack(warp, number);
  LaneStack& entries = stack(warp, number);
  for (std::uint32_t pushed = entries.pushed(); pushed > 0; --pushed) {
    its.stack.push(shared_.stack_size, [&](std::uint32_t line) {
      spills_.push_back({warps_[warp].entered, number, warp, stack_line(warp, number, line)});
    });
  }
  if (visit != nullptr) {
    its.to_read = its.stack.pop(shared_.stack_size, entries.popped_for(program::operand_of(*visit)));
    its.goes_on = its.to_read > 0;
    its.visit = *visit;
    its.record = lane(warp, number).record;
  } else {
    // A shadow ray ends with its hit; others drop one entry after the other.
    const bool all = program::ray_kind_of(lane(warp, number).ray) != program::RayKind::shadow;
    its.to_read = all ? its.stack.pop(shared_.stack_size, entries.popped_for_all()) : 0;
    entries.end_ray();
  }
  time_.counts().fills += its.to_read;
  return its.to_read > 0 && read_stack(warp, number);
}

// The lines that were filled in this cycle wait for the write buffer.
void SimtNode::write_stacks() {
  std::stable_sort(spills_.begin(), spills_.end(), [](const Spill& a, const Spill& b) {
    return a.entered != b.entered ? a.entered < b.entered : a.lane < b.lane;
  });
  for (const Spill& spill : spills_) {
    writers_.push_back({spill.warp, spill.line});
    ++warps_[spill.warp].unposted;
    ++time_.counts().spills;
  }
  spills_.clear();
}

}  // namespace marti::processors::simt
