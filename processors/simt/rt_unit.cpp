#include "processors/simt/rt_unit.h"

#include <algorithm>
#include <bit>

#include "processors/simt/simt_node.h"
#include "processors/walk/prefetch_lines.h"

namespace marti::processors::simt {

void SimtNode::leave_and_enter() {
  const machine::RtUnitConfig& rt = shared_.input.config.rt;
  const auto first =
      std::find_if(in_unit_.begin(), in_unit_.end(), [&](std::uint32_t warp) { return leaves(warp); });
  if (first != in_unit_.end()) {
    const std::uint32_t number = *first;
    in_unit_.erase(first);
    Warp& warp = warps_[number];
    unit_slots_ &= ~(std::uint64_t{1} << warp.slot);
    warp.state = LaneState::held;
    warp.state_lanes = 0;
    if (is_group(number)) {
      end_group(number);
    } else {
      begin_shading(number, warp.picked);
    }
  }
  sort_pool();
  if (!unit_waiters_.empty() && in_unit_.size() < rt.warps &&
      warps_[unit_waiters_.front()].trace_began < cycle_) {
    const std::uint32_t number = unit_waiters_.front();
    unit_waiters_.pop_front();
    Warp& warp = warps_[number];
    warp.does = Does::traces;
    warp.slot = static_cast<std::uint32_t>(std::countr_one(unit_slots_));
    unit_slots_ |= std::uint64_t{1} << warp.slot;
    warp.entered = entered_++;
    warp.wants = warp.members;
    if (is_group(number)) {
      move(number, warp.members, LaneState::unit, LaneState::scheduler);
    } else {
      place(number, LaneState::scheduler, warp.members);
    }
    in_unit_.push_back(number);
    ++time_.counts().traces;
  }
}

std::optional<std::uint32_t> SimtNode::pick_warp() const {
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

std::optional<SimtNode::Picked> SimtNode::pick_by_treelet() {
  const auto pick = [&]() -> std::optional<Picked> {
    for (const std::uint32_t warp : in_unit_) {
      for (Lanes wants = warps_[warp].wants; wants != 0; wants &= wants - 1) {
        const auto number = static_cast<std::uint32_t>(std::countr_zero(wants));
        if (lane_treelet(warp, number) == last_treelet_) {
          return Picked{warp, number};
        }
      }
    }
    return std::nullopt;
  };
  if (const std::optional<Picked> picked = pick()) {
    return picked;
  }
  wanted_.clear();
  for (const std::uint32_t warp : in_unit_) {
    for_each_lane(warps_[warp].wants,
                  [&](std::uint32_t number) { wanted_.push_back(lane_treelet(warp, number)); });
  }
  std::sort(wanted_.begin(), wanted_.end());
  std::ptrdiff_t most = 0;
  for (auto first = wanted_.begin(); first != wanted_.end();) {
    const auto next = std::upper_bound(first, wanted_.end(), *first);
    if (next - first > most) {
      most = next - first;
      last_treelet_ = *first;
    }
    first = next;
  }
  return pick();
}

std::optional<SimtNode::Picked> SimtNode::pick_lane() {
  if (shared_.input.config.rt.scheduler == machine::RtScheduler::treelet) {
    return pick_by_treelet();
  }
  const std::optional<std::uint32_t> warp = pick_warp();
  if (!warp) {
    return std::nullopt;
  }
  last_slot_ = warps_[*warp].slot;
  last_entered_ = warps_[*warp].entered;
  return Picked{*warp, static_cast<std::uint32_t>(std::countr_zero(warps_[*warp].wants))};
}

bool SimtNode::pick_access() {
  const std::optional<Picked> picked = pick_lane();
  if (!picked) {
    return false;
  }
  const Lane& first = lane(picked->warp, picked->lane);
  const Record record = first.record;
  sending_ = accesses_.take();
  Access& access = accesses_[sending_];
  access = {std::move(access.lanes), record.kind, first.origin, works_for(picked->warp, picked->lane)};
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
      join(picked->warp, Lanes{1} << picked->lane);
      break;
    case machine::RtCoalesce::warp:
      join(picked->warp, warps_[picked->warp].wants);
      break;
    case machine::RtCoalesce::unit:
      join(picked->warp, warps_[picked->warp].wants);
      for (const std::uint32_t other : in_unit_) {
        if (other != picked->warp) {
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

// Counts the lanes of an access as being in a state.
void SimtNode::place_access(Access& access, LaneState state) {
  for (const WarpLanes& part : access.lanes) {
    move(part.warp, part.lanes, access.state, state);
  }
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
  const bool box = test == Test::box || test == Test::transform || test == Test::leaf;
  const LaneState state = box ? LaneState::box : LaneState::primitive;
  move(lanes.warp, lanes.lanes, from, state);
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
    if (next_record(lanes.warp, member)) {
      return;
    }
    done |= Lanes{1} << member;
    if (shares()) {
      leave_shared(lanes.warp, member);
      time_.move_lanes(LaneState::held, without_work(lanes.warp, member), 1);
    } else {
      end_ray(warps_[home_of(lanes.warp, member) / shared_.input.config.simt.lanes].trace_began);
    }
  });
  warp.wants |= lanes.lanes & ~done;
  warp.tracing &= ~done;
  move(lanes.warp, lanes.lanes & ~done, from, LaneState::scheduler);
  move(lanes.warp, done, from, LaneState::held);
}

// Takes a lane to the first record of its ray, or to the next if the ray goes on after an answer.
bool SimtNode::begin_ray(std::uint32_t warp, std::uint32_t number) {
  if (lane(warp, number).goes_back) {
    const std::size_t wishes = wishes_.size();
    const std::size_t wished = wished_.size();
    const bool more = next_record(warp, number);
    wishes_.resize(wishes);  // outside of the unit it has none
    wished_.resize(wished);
    return more;
  }
  if (!stacks_.empty()) {
    stack(warp, number).begin_ray();
  }
  if (!spilled_stacks_.empty()) {
    spilled_stack(warp, number).stack.clear();
  }
  if (!lane_treelets_.empty()) {
    lane_treelet(warp, number) = no_treelet;
  }
  return shares() ? begin_shared(warp, number) : next_record(warp, number);
}

// Takes a lane in the unit, or one that is to enter it, to its next record.
bool SimtNode::next_record(std::uint32_t warp, std::uint32_t number) {
  if (!spilled_stacks_.empty() && read_stack(warp, number)) {
    return true;
  }
  if (shares()) {
    return next_shared(warp, number);
  }
  Lane& its = lane(warp, number);
  const std::uint32_t* const visit = its.word;
  const bool more = shared_.walk.next_record(its, statistics_.steps);
  if (!more && LaneWalk::waits_for_answer(its)) {
    return false;
  }
  if (!spilled_stacks_.empty() && (!more || its.word != visit) &&
      move_stack(warp, number, more ? visit : nullptr)) {
    return true;
  }
  if (!more) {
    return false;
  }
  if (its.word != visit && (!stacks_.empty() || !lane_treelets_.empty())) {
    follow(warp, number, *visit);
  }
  return true;
}

// A lane goes on with a visit: notes what it wishes for.
void SimtNode::follow(std::uint32_t warp, std::uint32_t number, std::uint32_t visit) {
  const std::uint32_t node = program::operand_of(visit);
  Wish wish = {warps_[warp].entered, number, static_cast<std::uint32_t>(wished_.size())};
  if (!stacks_.empty()) {
    // What is in memory is not known on chip.
    const std::uint32_t near = spilled_stacks_.empty() ? ~0U : spilled_stack(warp, number).stack.near();
    stack(warp, number)
        .visit(shared_.input.log.topology.nodes, node, std::min(near, shared_.input.config.prefetch.stack),
               [&](std::uint32_t waiting) { wished_.push_back(waiting); });
  }
  wish.end = static_cast<std::uint32_t>(wished_.size());
  if (!lane_treelets_.empty()) {
    const std::uint32_t before = lane_treelet(warp, number);
    const std::uint32_t now = program::visits_node(program::step_of(visit)) ? shared_.treelets->of_node[node]
                              : before == no_treelet                        ? 0
                                                                            : before;
    lane_treelet(warp, number) = now;
    if (shared_.input.config.prefetch.treelet && before != no_treelet && before != now) {
      wish.treelet = now;
    }
  }
  if (wish.end != wish.first || wish.treelet != no_treelet) {
    wishes_.push_back(wish);
  }
}

// Puts the lines of what the lanes wish for in this cycle into the queue.
void SimtNode::put_prefetches() {
  std::sort(wishes_.begin(), wishes_.end(), [](const Wish& a, const Wish& b) {
    return a.entered != b.entered ? a.entered < b.entered : a.lane < b.lane;
  });
  const memory::Layout& layout = shared_.input.layout;
  const auto put = [&](memory::RecordKind kind, std::uint32_t line) {
    prefetches_.put({shared_.caches.key(number_, kind, line), line, kind});
    return true;
  };
  for (const Wish& wish : wishes_) {
    for (std::uint32_t i = wish.first; i < wish.end; ++i) {
      const Record record = shared_.walk.first_record(wished_[i]);
      shared_.each_unit(record.at, record.bytes, [&](std::uint32_t unit) { (void)put(record.kind, unit); });
    }
    if (wish.treelet != no_treelet) {
      const auto kind = memory::RecordKind::node;
      const std::uint32_t first = shared_.treelets->begin[wish.treelet];
      (void)walk::each_line_of(
          shared_.treelets->begin[wish.treelet + 1] - first, shared_.unit_shift,
          [&](std::uint32_t number) {
            return std::optional(
                walk::RecordBytes{layout.address(kind, first + number), layout.record_bytes(kind)});
          },
          [&](std::uint32_t line) { return put(kind, line); });
    }
  }
  wishes_.clear();
  wished_.clear();
}

// A ray reads its first record, or its first one after an answer.
void SimtNode::count_ray(std::uint32_t warp, std::uint32_t number) {
  ++(lane(warp, number).goes_back ? time_.counts().returns : time_.counts().rays);
}

void SimtNode::end_ray(std::int64_t began) {
  const std::int64_t cycles = cycle_ - began;
  time_.counts().ray_cycles += cycles;
  time_.counts().longest_ray = std::max(time_.counts().longest_ray, cycles);
}

}  // namespace marti::processors::simt
