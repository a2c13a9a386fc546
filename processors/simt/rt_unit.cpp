#include "processors/simt/rt_unit.h"

#include <algorithm>
#include <bit>

#include "processors/simt/simt_node.h"

namespace marti::processors::simt {

void SimtNode::leave_and_enter() {
  const machine::RtUnitConfig& rt = shared_.input.config.rt;
  const auto leaves = std::find_if(in_unit_.begin(), in_unit_.end(),
                                   [&](std::uint32_t warp) { return warps_[warp].tracing == 0; });
  if (leaves != in_unit_.end()) {
    const std::uint32_t number = *leaves;
    in_unit_.erase(leaves);
    Warp& warp = warps_[number];
    unit_slots_ &= ~(std::uint64_t{1} << warp.slot);
    warp.state = LaneState::held;
    warp.state_lanes = 0;
    begin_shading(number, warp.picked);
  }
  if (!unit_waiters_.empty() && in_unit_.size() < rt.warps) {
    const std::uint32_t number = unit_waiters_.front();
    unit_waiters_.pop_front();
    Warp& warp = warps_[number];
    warp.does = Does::traces;
    warp.slot = static_cast<std::uint32_t>(std::countr_one(unit_slots_));
    unit_slots_ |= std::uint64_t{1} << warp.slot;
    warp.entered = entered_++;
    warp.wants = warp.members;
    place(warp, LaneState::scheduler, count(warp.members));
    in_unit_.push_back(number);
    ++time_.counts().traces;
  }
}

std::optional<std::uint32_t> SimtNode::pick_warp() {
  const auto wants = [&](std::uint32_t warp) { return warps_[warp].wants != 0; };
  const machine::RtScheduler scheduler = shared_.input.config.rt.scheduler;
  if (scheduler == machine::RtScheduler::round_robin) {
    std::optional<std::uint32_t> next;
    std::uint32_t least = machine::most_warps;
    for (const std::uint32_t warp : in_unit_) {
      const std::uint32_t distance =
          (warps_[warp].slot + machine::most_warps - 1 - last_slot_) % machine::most_warps;
      if (wants(warp) && distance < least) {
        least = distance;
        next = warp;
      }
    }
    return next;
  }
  std::optional<std::uint32_t> oldest;
  for (const std::uint32_t warp : in_unit_) {
    if (!wants(warp)) {
      continue;
    }
    if (scheduler == machine::RtScheduler::greedy && last_entered_ == warps_[warp].entered) {
      return warp;
    }
    if (!oldest) {
      oldest = warp;
    }
  }
  return oldest;
}

bool SimtNode::pick_access() {
  const std::optional<std::uint32_t> picked = pick_warp();
  if (!picked) {
    return false;
  }
  last_slot_ = warps_[*picked].slot;
  last_entered_ = warps_[*picked].entered;
  const auto first = static_cast<std::uint32_t>(std::countr_zero(warps_[*picked].wants));
  const Record record = lane(*picked, first).record;
  sending_ = accesses_.take();
  Access& access = accesses_[sending_];
  access = {std::move(access.lanes), record.kind, lane(*picked, first).origin};
  access.lanes.clear();
  std::uint64_t bytes = 0;
  const auto join = [&](std::uint32_t number, Lanes candidates) {
    Lanes joined = 0;
    for_each_lane(candidates, [&](std::uint32_t other) {
      const Record& its = lane(number, other).record;
      if (its.at == record.at) {
        joined |= Lanes{1} << other;
        bytes = std::max(bytes, its.bytes);
      }
    });
    if (joined != 0) {
      warps_[number].wants &= ~joined;
      access.lanes.push_back({number, joined});
      access.count += count(joined);
    }
  };
  switch (shared_.input.config.rt.coalesce) {
    case machine::RtCoalesce::none:
      join(*picked, Lanes{1} << first);
      break;
    case machine::RtCoalesce::warp:
      join(*picked, warps_[*picked].wants);
      break;
    case machine::RtCoalesce::unit:
      join(*picked, warps_[*picked].wants);
      for (const std::uint32_t other : in_unit_) {
        if (other != *picked) {
          join(other, warps_[other].wants);
        }
      }
      break;
  }
  access.next_unit = static_cast<std::uint32_t>(record.at >> shared_.unit_shift);
  access.last_unit = static_cast<std::uint32_t>((record.at + bytes - 1) >> shared_.unit_shift);
  ++time_.counts().accesses;
  time_.counts().records += access.count;
  return true;
}

// All lines of an access have been looked up; at least one is not there yet.
void SimtNode::sent(Access& access) {
  access.sent = true;
  const LaneState state = access.left > 0 ? LaneState::memory : LaneState::cache;
  time_.move_lanes(access.state, state, access.count);
  access.state = state;
}

// The lanes of an access have their record.
void SimtNode::complete(std::uint32_t number) {
  const Access& access = accesses_[number];
  for (const WarpLanes& part : access.lanes) {
    std::array<Lanes, tests> of_test{};
    for_each_lane(part.lanes, [&](std::uint32_t member) {
      of_test[static_cast<std::size_t>(lane(part.warp, member).record.test)] |= Lanes{1} << member;
    });
    for (std::size_t test = 0; test < tests; ++test) {
      if (of_test[test] != 0) {
        begin_test({part.warp, of_test[test]}, static_cast<Test>(test), access.state);
      }
    }
  }
  accesses_.give_back(number);
}

void SimtNode::begin_test(const WarpLanes& lanes, Test test, LaneState from) {
  const std::int64_t cycles = shared_.test_cycles[static_cast<std::size_t>(test)];
  if (cycles == 0) {
    ending_.push_back({lanes, from});
    return;
  }
  const bool box = test == Test::box || test == Test::leaf;
  const LaneState state = box ? LaneState::box : LaneState::primitive;
  time_.move_lanes(from, state, count(lanes.lanes));
  const machine::RtUnitConfig& rt = shared_.input.config.rt;
  if ((box ? rt.box_units : rt.triangle_units) == 0) {
    const std::uint32_t running = running_.take();
    running_[running] = {lanes, state};
    queue_.push(sim::add_ticks(cycle_, cycles), {Due::test, running});
    ++tests_running_;
    return;
  }
  for_each_lane(lanes.lanes, [&](std::uint32_t member) {
    (box ? waiting_boxes_ : waiting_primitives_)
        .push_back({warps_[lanes.warp].entered, lanes.warp, member, cycles});
    ++(box ? new_boxes_ : new_primitives_);
  });
}

void SimtNode::begin_waiting_tests() {
  const auto begin = [&](std::vector<WaitingTest>& waiting, std::size_t& added, std::uint32_t units,
                         LaneState state) {
    std::sort(waiting.end() - static_cast<std::ptrdiff_t>(added), waiting.end());
    added = 0;
    const auto first = static_cast<std::ptrdiff_t>(std::min<std::size_t>(units, waiting.size()));
    for (auto test = waiting.begin(); test != waiting.begin() + first; ++test) {
      const std::uint32_t running = running_.take();
      running_[running] = {{test->warp, Lanes{1} << test->lane}, state};
      queue_.push(sim::add_ticks(cycle_, test->cycles), {Due::test, running});
      ++tests_running_;
    }
    waiting.erase(waiting.begin(), waiting.begin() + first);
  };
  const machine::RtUnitConfig& rt = shared_.input.config.rt;
  begin(waiting_boxes_, new_boxes_, rt.box_units, LaneState::box);
  begin(waiting_primitives_, new_primitives_, rt.triangle_units, LaneState::primitive);
}

void SimtNode::end_test(const WarpLanes& lanes, LaneState from) {
  Warp& warp = warps_[lanes.warp];
  Lanes done = 0;
  for_each_lane(lanes.lanes, [&](std::uint32_t member) {
    if (!shared_.walk.next_record(lane(lanes.warp, member), statistics_.steps)) {
      done |= Lanes{1} << member;
      end_ray(lanes.warp);
    }
  });
  warp.wants |= lanes.lanes & ~done;
  warp.tracing &= ~done;
  time_.move_lanes(from, LaneState::scheduler, count(lanes.lanes & ~done));
  time_.move_lanes(from, LaneState::held, count(done));
}

void SimtNode::end_ray(std::uint32_t warp) {
  const std::int64_t cycles = cycle_ - warps_[warp].trace_began;
  time_.counts().ray_cycles += cycles;
  time_.counts().longest_ray = std::max(time_.counts().longest_ray, cycles);
}

}  // namespace marti::processors::simt
