// Warps beside the unit: packets, shader phases, rounds without a unit, pixels.
#include <algorithm>
#include <bit>

#include "processors/simt/simt_node.h"
#include "processors/walk/observer.h"

namespace marti::processors::simt {

namespace {

std::uint32_t pixels_of(const machine::Packet& packet) {
  return (packet.x1 - packet.x0) * (packet.y1 - packet.y0);
}

RoundCounts round_counts(const cost::StepCounts& steps) {
  return {steps.branches,     steps.transforms, steps.leaves,
          steps.cuts,         steps.passes,     steps.tests - steps.sphere_tests - steps.cone_tests,
          steps.sphere_tests, steps.cone_tests};
}

std::int64_t product(std::int64_t cycles, std::int64_t steps) { return sim::multiply_ticks(cycles, steps); }

// Inserts a warp into those that are served in the order of (cycle, number of the warp).
template <class Waiting, class CycleOf>
void insert_in_order(Waiting& waiting, std::uint32_t warp, const CycleOf& cycle_of) {
  auto at = waiting.end();
  const std::int64_t cycle = cycle_of(warp);
  while (at != waiting.begin()) {
    const std::uint32_t before = *(at - 1);
    const std::int64_t earlier = cycle_of(before);
    if (earlier < cycle || (earlier == cycle && before < warp)) {
      break;
    }
    --at;
  }
  waiting.insert(at, warp);
}

}  // namespace

// Counts these lanes of the warp as being in a state, and its others that have a pixel as held.
void SimtNode::place(std::uint32_t number, LaneState state, Lanes lanes) {
  Warp& warp = warps_[number];
  move(number, warp.state_lanes, warp.state, LaneState::held);
  move(number, lanes, LaneState::held, state);
  warp.state = state;
  warp.state_lanes = lanes;
}

void SimtNode::begin_turn(std::uint32_t number) {
  Warp& warp = warps_[number];
  const std::uint32_t lanes = shared_.input.config.simt.lanes;
  const std::uint32_t first = warp.turn * lanes;
  const std::uint32_t with_pixel = std::min(lanes, pixels_of(warp.packet) - first);
  warp.pixels = lowest(with_pixel);
  warp.rays = 0;
  for (std::uint32_t i = 0; i < with_pixel; ++i) {
    const walk::PixelPlace pixel = pixel_of(warp.packet, first + i);
    shared_.walk.begin_pixel(lane(number, i), pixel.x, pixel.y);
    if (!stacks_.empty()) {
      stack(number, i).begin_pixel(shared_.input.log.entered(pixel.x, pixel.y));
    }
  }
  time_.add_lanes(LaneState::held, with_pixel);
  time_.add_lanes(LaneState::empty, lanes - with_pixel);
  begin_shading(number, warp.pixels);
}

void SimtNode::begin_shading(std::uint32_t number, Lanes members) {
  Warp& warp = warps_[number];
  warp.members = members;
  warp.rays &= ~members;
  warp.ended = 0;
  warp.lines.clear();
  ShaderCounts most{};
  for_each_lane(members, [&](std::uint32_t member) {
    ShaderCounts counts{};
    const auto read = [&](memory::RecordKind kind, memory::Address at, std::uint32_t bytes) {
      shared_.each_unit(at, bytes, [&](std::uint32_t unit) {
        if (std::none_of(warp.lines.rbegin(), warp.lines.rend(),
                         [&](const LineRead& other) { return other.unit == unit; })) {
          warp.lines.push_back({unit, kind, lane(number, member).origin, place_of(number, member)});
        }
      });
    };
    const bool holds = shared_.walk.shade(lane(number, member), counts, read);
    (holds ? warp.rays : warp.ended) |= Lanes{1} << member;
    LaneWalk::add(counts, statistics_.steps);
    for (std::size_t step = 0; step < shader_steps; ++step) {
      most[step] = std::max(most[step], counts[step]);
    }
  });
  warp.compute = {};
  for (std::size_t step = 0; step < shader_steps; ++step) {
    std::int64_t& part = step < program::ray_kinds ? warp.compute.traversal : warp.compute.shading;
    part = sim::add_ticks(part, product(shared_.shader_cycles[step], most[step]));
  }
  begin_phase(number, Does::shading);
}

// The warp's lines and computing are known.
void SimtNode::begin_phase(std::uint32_t number, Does does) {
  Warp& warp = warps_[number];
  warp.does = does;
  warp.began = cycle_;
  warp.next_line = 0;
  warp.computing = Computing::none;
  if (!warp.lines.empty()) {
    insert_in_order(readers_, number, [&](std::uint32_t other) { return warps_[other].began; });
  }
  if (warp.compute.all() > 0) {
    if (does == Does::round && !warp.lines.empty()) {
      warp.computing = Computing::reads;
    } else {
      ask_for_slot(number);
    }
  }
  refresh_phase(number);
  touched_ |= std::uint64_t{1} << number;
}

void SimtNode::ask_for_slot(std::uint32_t number) {
  warps_[number].computing = Computing::waits;
  insert_in_order(slot_waiters_, number, [&](std::uint32_t other) { return warps_[other].began; });
}

bool SimtNode::phase_done(const Warp& warp) {
  const bool computed = warp.computing == Computing::none || warp.computing == Computing::over;
  return computed && warp.next_line == warp.lines.size() && warp.pending == 0;
}

// What the lanes of a phase or round do now.
void SimtNode::refresh_phase(std::uint32_t number) {
  Warp& warp = warps_[number];
  LaneState state = LaneState::cache;
  if (warp.computing == Computing::waits) {
    state = LaneState::slot;
  } else if (warp.computing == Computing::runs) {
    state = LaneState::shading;
  } else if (warp.next_line != warp.lines.size()) {
    state = LaneState::scheduler;
  } else if (warp.left > 0) {
    state = LaneState::memory;
  }
  if (state != warp.state || warp.members != warp.state_lanes) {
    place(number, state, warp.members);
  }
}

void SimtNode::give_slots() {
  while (slots_.size() < shared_.input.config.simt.issue && !slot_waiters_.empty()) {
    const std::uint32_t number = slot_waiters_.front();
    slot_waiters_.erase(slot_waiters_.begin());
    Warp& warp = warps_[number];
    warp.computing = Computing::runs;
    auto at = slots_.end();
    while (at != slots_.begin() && (at - 1)->taken == cycle_ && (at - 1)->warp > number) {
      --at;
    }
    slots_.insert(at, {number, cycle_, warp.compute});
    queue_.push(sim::add_ticks(cycle_, warp.compute.all()), {Due::slot, number});
    refresh_phase(number);
  }
}

// Lets a warp go on as far as it takes no time.
void SimtNode::advance(std::uint32_t number) {
  Warp& warp = warps_[number];
  for (;;) {
    switch (warp.does) {
      case Does::shading:
        if (!phase_done(warp)) {
          return;
        }
        end_shading(number);
        break;
      case Does::round:
        if (!phase_done(warp)) {
          return;
        }
        (void)next_round_records(number, warp.members);
        if (warp.members == 0) {
          begin_shading(number, warp.picked);
        } else {
          begin_phase(number, Does::round);
        }
        break;
      case Does::writing:
        if (warp.next_write != warp.writes.size()) {
          return;
        }
        go_on(number);
        break;
      case Does::nothing:
      case Does::waits_for_unit:
      case Does::traces:
        return;
    }
  }
}

// The pixels that have ended in the phase are to be written.
void SimtNode::end_shading(std::uint32_t number) {
  Warp& warp = warps_[number];
  place(number, LaneState::held, 0);
  warp.does = Does::writing;
  warp.writes.clear();
  warp.next_write = 0;
  if (warp.ended == 0 || shared_.input.config.pixels != machine::Pixels::written) {
    return;
  }
  const memory::Layout& layout = shared_.input.layout;
  const std::uint32_t bytes = layout.record_bytes(memory::RecordKind::pixel);
  const std::uint32_t line = shared_.input.config.cache.cache.line;
  for_each_lane(warp.ended, [&](std::uint32_t member) {
    const walk::PixelPlace pixel =
        pixel_of(warp.packet, warp.turn * shared_.input.config.simt.lanes + member);
    const memory::Address at =
        layout.address(memory::RecordKind::pixel, std::uint64_t{pixel.y} * shared_.input.log.width + pixel.x);
    if (!warp.writes.empty()) {
      Write& last = warp.writes.back();
      if (last.at + last.bytes == at && (at + bytes - 1) / line == last.at / line) {
        last.bytes += bytes;
        return;
      }
    }
    warp.writes.push_back({at, bytes});
  });
  writers_.push_back({number, std::nullopt});
  write_out();
}

// Posts the writes for which there is room.
void SimtNode::write_out() {
  const std::uint32_t line = shared_.input.config.reference_bytes();
  while (!writers_.empty()) {
    const Writer writer = writers_.front();
    Warp& warp = warps_[writer.warp];
    if (writer.line) {
      if (!room_.has_room(number_, writes.size())) {
        return;
      }
      writes.push_back({*writer.line, line, false});
      --warp.unposted;
      writers_.pop_front();
      continue;
    }
    while (warp.next_write != warp.writes.size() && room_.has_room(number_, writes.size())) {
      writes.push_back(warp.writes[warp.next_write++]);
    }
    if (warp.next_write != warp.writes.size()) {
      return;
    }
    touched_ |= std::uint64_t{1} << writer.warp;
    writers_.pop_front();
  }
}

// A shader phase is over, and its pixels are written.
void SimtNode::go_on(std::uint32_t number) {
  Warp& warp = warps_[number];
  if (warp.rays != 0) {
    begin_trace(number);
    return;
  }
  const std::uint32_t lanes = shared_.input.config.simt.lanes;
  time_.add_lanes(LaneState::held, -count(warp.pixels));
  time_.add_lanes(LaneState::empty, count(warp.pixels) - lanes);
  if (std::uint64_t{++warp.turn} * lanes < pixels_of(warp.packet)) {
    begin_turn(number);
    return;
  }
  warp.does = Does::nothing;
  time_.counts().longest_warp = std::max(time_.counts().longest_warp, cycle_ - warp.packet_began);
  ++without_packet_;
  asks.push_back(number);
}

void SimtNode::begin_trace(std::uint32_t number) {
  Warp& warp = warps_[number];
  warp.picked = warp.rays;
  if (shared_.input.config.simt.reconverge == machine::Reconverge::kind) {
    // The operand of a ray has its bounce above its kind.
    std::uint32_t least = ~0U;
    for_each_lane(warp.rays,
                  [&](std::uint32_t member) { least = std::min(least, lane(number, member).ray); });
    warp.picked = 0;
    for_each_lane(warp.rays, [&](std::uint32_t member) {
      warp.picked |= lane(number, member).ray == least ? Lanes{1} << member : 0;
    });
  }
  warp.trace_began = cycle_;
  warp.tracing = 0;
  if (shared_.input.config.rt.warps == 0) {
    if (next_round_records(number, warp.picked)) {
      begin_phase(number, Does::round);
      return;
    }
  } else {
    for_each_lane(warp.picked, [&](std::uint32_t member) {
      if (begin_ray(number, member)) {
        warp.tracing |= Lanes{1} << member;
      }
    });
    if (warp.tracing != 0) {
      for_each_lane(warp.tracing, [&](std::uint32_t member) { count_ray(number, member); });
      warp.members = warp.tracing;
      if (shared_.input.config.rt.sort != machine::RaySort::none) {
        put_into_pool(number);
        return;
      }
      warp.does = Does::waits_for_unit;
      place(number, LaneState::unit, warp.picked);
      insert_in_order(unit_waiters_, number, [&](std::uint32_t other) { return warps_[other].trace_began; });
      return;
    }
  }
  begin_shading(number, warp.picked);
}

// Finds what each of these lanes does in the next round: the round's members are those that do anything. True
// when one reads a record.
bool SimtNode::next_round_records(std::uint32_t number, Lanes lanes) {
  struct RoundAccess {
    Record record;
    walk::Origin origin;
    std::size_t lane;
  };
  Warp& warp = warps_[number];
  std::vector<RoundAccess> accesses;
  RoundCounts most{};
  warp.members = 0;
  for_each_lane(lanes, [&](std::uint32_t member) {
    const Lanes bit = Lanes{1} << member;
    cost::StepCounts steps;
    const bool reads_record = shared_.walk.next_record(lane(number, member), steps);
    const RoundCounts counts = round_counts(steps);
    if (reads_record) {
      const Record& record = lane(number, member).record;
      const auto shared = std::find_if(accesses.begin(), accesses.end(), [&](const RoundAccess& other) {
        return other.record.at == record.at;
      });
      if (shared != accesses.end() && shared_.input.config.rt.coalesce != machine::RtCoalesce::none) {
        shared->record.bytes = std::max(shared->record.bytes, record.bytes);
      } else {
        accesses.push_back({record, lane(number, member).origin, place_of(number, member)});
      }
      ++time_.counts().records;
      if ((warp.tracing & bit) == 0) {
        count_ray(number, member);
      }
      warp.tracing |= bit;
      warp.members |= bit;
    } else if (counts != RoundCounts{}) {
      warp.members |= bit;
    } else if ((warp.tracing & bit) != 0) {
      end_ray(warp.trace_began);
    }
    sim::merge(statistics_.steps, steps);
    for (std::size_t step = 0; step < round_steps; ++step) {
      most[step] = std::max(most[step], counts[step]);
    }
  });
  warp.lines.clear();
  for (const RoundAccess& access : accesses) {
    shared_.each_unit(access.record.at, access.record.bytes, [&](std::uint32_t unit) {
      warp.lines.push_back({unit, access.record.kind, access.origin, access.lane});
    });
  }
  time_.counts().accesses += static_cast<std::int64_t>(accesses.size());
  warp.compute = {};
  for (std::size_t step = 0; step < round_steps; ++step) {
    std::int64_t& part = step < round_visits ? warp.compute.traversal : warp.compute.intersection;
    part = sim::add_ticks(part, product(shared_.round_cycles[step], most[step]));
  }
  return !accesses.empty();
}

}  // namespace marti::processors::simt
