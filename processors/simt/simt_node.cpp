#include "processors/simt/simt_node.h"

#include <algorithm>
#include <bit>

#include "processors/cost/step_time.h"
#include "processors/walk/node_order.h"

namespace marti::processors::simt {

SimtShared::SimtShared(const walk::ReplayInput& replay)
    : input(replay),
      walk(replay),
      caches(replay),
      behind(replay),
      unit_shift(static_cast<unsigned>(std::countr_zero(replay.config.reference_bytes()))) {
  const cost::StepTicks ticks = cost::step_ticks(replay.config, replay.log);
  const sim::Ticks period = replay.config.clock.period();
  for (std::size_t kind = 0; kind < program::ray_kinds; ++kind) {
    shader_cycles[kind] = ticks.ray[kind] / period;
  }
  const auto price = [&](ShaderStep step, sim::Ticks of_step) {
    shader_cycles[static_cast<std::size_t>(step)] = of_step / period;
  };
  price(ShaderStep::shade, ticks.shade);
  price(ShaderStep::light, ticks.light);
  price(ShaderStep::texel, ticks.texel);
  price(ShaderStep::any_hit, ticks.any_hit);
  price(ShaderStep::pixel, ticks.pixel);
  const RoundCounts of_round = {ticks.branch, ticks.transform, ticks.leaf,        ticks.cut,
                                ticks.pass,   ticks.test,      ticks.sphere_test, ticks.cone_test};
  for (std::size_t step = 0; step < round_steps; ++step) {
    round_cycles[step] = of_round[step] / period;
  }
  listener = walk::hears_references(replay) ? replay.observer : nullptr;
  if (replay.config.count.any()) {
    counting.emplace(replay.config, walk::memory_lines(replay.config, replay.layout, nullptr));
  }
  const machine::RtUnitConfig& rt = replay.config.rt;
  if (rt.scheduler == machine::RtScheduler::treelet || replay.config.prefetch.treelet) {
    treelets = accel::treelets_of(replay.log.topology, !accel::walks_bvh(replay.log.traversal),
                                  walk::treelet_records(replay.config.layout));
  }
  if (rt.share != machine::RtShare::none && replay.log.order == accel::WalkOrder::treelet_first) {
    order_treelets = accel::treelets_of(replay.log.topology, false, replay.log.treelet_records).of_node;
  }
  if (rt.stack > 0) {
    stack_places = walk::stack_places(replay.log, replay.config, replay.layout);
    stack_size = {rt.stack, replay.config.reference_bytes() / machine::stack_entry_bytes};
  }
  test_cycles = {
      0, rt.box_cycles, rt.transform_cycles, rt.leaf_cycles, rt.triangle_cycles, rt.quadric_cycles};
}

SimtNode::SimtNode(SimtShared& shared, const WriteRoom& room, cost::NodeStatistics& statistics,
                   std::uint32_t number)
    : shared_(shared),
      room_(room),
      statistics_(statistics),
      number_(number),
      warps_(shared.input.config.simt.warps),
      lanes_(std::size_t{shared.input.config.simt.warps} * shared.input.config.simt.lanes),
      registers_(shared.input.config.simt.mshrs),
      live_(shared.input.config.simt.warps),
      without_packet_(live_),
      last_slot_(machine::most_warps - 1),
      prefetches_(shared.input.config.prefetch.queue),
      stacks_(shared.input.config.prefetch.stack > 0 || shared.input.config.rt.stack > 0 ? lanes_.size() : 0),
      spilled_stacks_(shared.input.config.rt.stack > 0 ? lanes_.size() : 0),
      shares_(shared.input.config.rt.share != machine::RtShare::none),
      lane_treelets_(shared.treelets ? lanes_.size() : 0) {
  if (shares()) {
    make_room_to_share();
  }
  if (shared.input.observer != nullptr && shared.input.observer->hears_lanes()) {
    lane_since_.resize(lanes_.size());
  }
  told_ = shared.listener != nullptr || !lane_since_.empty();
}

// Tells what lanes have done that leave a state.
void SimtNode::tell_of_lanes(std::uint32_t warp, Lanes lanes, LaneState from) {
  if (lane_since_.empty()) {
    return;
  }
  for_each_lane(lanes, [&](std::uint32_t member) {
    const std::int64_t since = std::exchange(lane_since_[home_of(warp, member)], cycle_);
    if (since != cycle_ && from != LaneState::held && from != LaneState::empty) {
      const bool working =
          from == LaneState::shading || from == LaneState::box || from == LaneState::primitive;
      shared_.input.observer->lane_spent(working, shared_.input.config.clock.cycles(cycle_ - since),
                                         pixel_at(works_for(warp, member)));
    }
  });
}

void SimtNode::settle(std::int64_t cycle) {
  Quiet quiet = Quiet::idle;
  if (registers_.left() > 0) {
    quiet = Quiet::memory;
  } else if (registers_.wanted() > 0 || hits_pending_ > 0) {
    quiet = Quiet::cache;
  } else if (tests_running_ > 0) {
    quiet = Quiet::testing;
  } else if (!writers_.empty()) {
    quiet = Quiet::writing;
  } else if (without_packet_ > 0) {
    quiet = Quiet::dispatch;
  }
  const auto tested_first = [&] {
    std::int64_t first = no_cycle;
    cost::Activity activity = cost::Activity::traversal;
    queue_.for_each([&](std::int64_t due, const DueEntry& entry) {
      if (entry.due != Due::test || due > first) {
        return;
      }
      const bool box = running_[entry.of].state == LaneState::box;
      if (due < first || box) {
        activity = box ? cost::Activity::traversal : cost::Activity::intersection;
      }
      first = due;
    });
    return activity;
  };
  time_.settle(cycle, slots_.empty() ? nullptr : slots_.data(), quiet,
               static_cast<std::int64_t>(in_unit_.size()), registers_.used(), tested_first);
}

void SimtNode::step(std::int64_t cycle) {
  settle(cycle);
  cycle_ = cycle;
  stepped_ = cycle;
  // Steps 1 and 2.
  queue_.take(cycle, [&](const DueEntry& entry) {
    switch (entry.due) {
      case Due::packet:
        --without_packet_;
        begin_turn(entry.of);
        break;
      case Due::slot:
        std::erase_if(slots_, [&](const Slot& slot) { return slot.warp == entry.of; });
        warps_[entry.of].computing = Computing::over;
        refresh_phase(entry.of);
        touched_ |= std::uint64_t{1} << entry.of;
        break;
      case Due::hit:
        --hits_pending_;
        line_there(entry.of, false);
        break;
      case Due::line: {
        LineRegisters::Register& line = registers_[entry.of];
        for (const std::uint32_t waiter : line.waiters) {
          line_there(waiter, line.left);
        }
        registers_.give_back(entry.of);
        break;
      }
      case Due::test: {
        const RunningTest& test = running_[entry.of];
        ending_.push_back({test.lanes, test.state});
        running_.give_back(entry.of);
        --tests_running_;
        break;
      }
      case Due::wake:
        break;
    }
  });
  for (const std::uint32_t access : completed_) {
    complete(access);
  }
  completed_.clear();
  begin_waiting_tests();
  // Step 3.
  for (const Ending& ending : ending_) {
    end_test(ending.lanes, ending.from);
  }
  ending_.clear();
  if (shares()) {
    help_each_other();
  }
  if (!wishes_.empty()) {
    put_prefetches();
  }
  if (!spills_.empty()) {
    write_stacks();
  }
  leave_and_enter();
  // Step 5.
  write_out();
  while (touched_ != 0) {
    const auto warp = static_cast<std::uint32_t>(std::countr_zero(touched_));
    touched_ &= touched_ - 1;
    advance(warp);
  }
  give_slots();
}

void SimtNode::begin_packet(std::uint32_t warp, const machine::Packet& packet) {
  set_packet(warp, packet, cycle_);
  --without_packet_;
  begin_turn(warp);
  advance(warp);
  touched_ = 0;  // no other warp has anything to go on with
  give_slots();
}

void SimtNode::expect_packet(std::uint32_t warp, const machine::Packet& packet, std::int64_t cycle) {
  set_packet(warp, packet, cycle);
  queue_.push(cycle, {Due::packet, warp});
}

void SimtNode::set_packet(std::uint32_t warp, const machine::Packet& packet, std::int64_t cycle) {
  warps_[warp].packet = packet;
  warps_[warp].packet_began = cycle;
  warps_[warp].turn = 0;
}

bool SimtNode::end_warp(std::uint32_t warp) {
  warps_[warp].over = true;
  --without_packet_;
  return --live_ == 0;
}

void SimtNode::look_up(std::int64_t cycle) {
  cycle_ = cycle;
  if (live_ == 0) {
    return;  // what waits to be prefetched is of no use to anybody
  }
  bool blocked = false;
  for (std::uint32_t port = 0; port < shared_.input.config.simt.ports && !blocked; ++port) {
    // A line for which there was no register comes before all others.
    const bool retried = full_from_ != no_cycle && sending_ == no_access;
    if (!retried && (sending_ != no_access || pick_access())) {
      Access& access = accesses_[sending_];
      blocked = !look_up_line(sending_, {access.next_unit, access.kind, access.origin, access.lane});
      if (!blocked && access.next_unit++ == access.last_unit) {
        sending_ = no_access;
        // At least one is not there yet.
        access.sent = true;
        place_access(access, access.left > 0 ? LaneState::memory : LaneState::cache);
      }
    } else if (!readers_.empty()) {
      const std::uint32_t number = readers_.front();
      Warp& warp = warps_[number];
      blocked = !look_up_line(phase_bit | number, warp.lines[warp.next_line]);
      if (!blocked && ++warp.next_line == warp.lines.size()) {
        readers_.erase(readers_.begin());
        refresh_phase(number);
      }
    } else if (!prefetches_.empty()) {
      look_up_prefetch();
    } else {
      break;
    }
  }
  const bool more = sending_ != no_access || !readers_.empty() || !prefetches_.empty() ||
                    std::any_of(in_unit_.begin(), in_unit_.end(),
                                [&](std::uint32_t warp) { return warps_[warp].wants != 0; });
  const bool unit = (!unit_waiters_.empty() && in_unit_.size() < shared_.input.config.rt.warps &&
                     warps_[unit_waiters_.front()].trace_began <= cycle) ||
                    pool_closes();
  const bool leave =
      std::any_of(in_unit_.begin(), in_unit_.end(), [&](std::uint32_t warp) { return leaves(warp); });
  if ((more && !blocked) || unit || leave || !waiting_boxes_.empty() || !waiting_primitives_.empty()) {
    queue_.push(cycle + 1, {});
  }
}

// Tells those who hear references, and lanes.
void SimtNode::tell_of_look_up(const LineRead& line, bool hit) {
  const machine::MachineConfig& config = shared_.input.config;
  if (shared_.listener != nullptr) {
    shared_.listener->referred(
        {config.clock.cycles(cycle_), number_, memory::Address{line.unit} << shared_.unit_shift,
         config.reference_bytes(), false},
        line.kind, hit);
  }
  if (!hit && !lane_since_.empty()) {
    shared_.input.observer->missed(number_, 1, pixel_at(line.lane));
  }
}

bool SimtNode::look_up_line(std::uint32_t waiter, const LineRead& line) {
  const std::uint64_t key = shared_.caches.key(number_, line.kind, line.unit);
  const auto note = [&](bool hit, bool joined) {
    ++(hit ? cost::hits_of(statistics_, line.kind) : cost::misses_of(statistics_, line.kind));
    time_.looked_up(line.kind);
    if (shared_.counting) {
      shared_.counting->refer(number_, static_cast<std::size_t>(key >> 32U), line.kind, line.unit,
                              line.origin, hit);
    }
    if (full_from_ != no_cycle) {
      time_.counts().full_cycles += cycle_ - full_from_;
      full_from_ = no_cycle;
    }
    prefetches_.look_up(key, hit, joined);
    if (told_) [[unlikely]] {
      tell_of_look_up(line, hit);
    }
  };
  if (const std::optional<std::uint32_t> under_way = registers_.find(key)) {
    (void)shared_.caches.access(number_, line.kind, line.unit);
    registers_[*under_way].waiters.push_back(waiter);
    registers_.want(*under_way);
    count_pending(waiter, registers_[*under_way].left);
    ++time_.counts().joined;
    note(true, true);
    return true;
  }
  if (registers_.full() && !shared_.caches.holds(number_, line.kind, line.unit)) {
    full_from_ = std::min(full_from_, cycle_);
    return false;
  }
  if (shared_.caches.access(number_, line.kind, line.unit)) {
    const std::int64_t hit_cycles = shared_.input.config.cache.hit_cycles;
    queue_.push(sim::add_ticks(cycle_, std::max<std::int64_t>(1, hit_cycles)), {Due::hit, waiter});
    ++hits_pending_;
    count_pending(waiter, false);
    note(true, false);
    return true;
  }
  note(false, false);
  const std::uint32_t number = ask_for_line(key, line, false);
  registers_[number].waiters.push_back(waiter);
  count_pending(waiter, registers_[number].left);
  return true;
}

void SimtNode::look_up_prefetch() {
  const PrefetchQueue::Line line = prefetches_.take();
  if (registers_.find(line.key) || shared_.caches.holds(number_, line.kind, line.unit)) {
    return;
  }
  if (registers_.full()) {
    prefetches_.drop();
    return;
  }
  (void)shared_.caches.access(number_, line.kind, line.unit);
  prefetches_.ask(line.key);
  if (shared_.counting) {
    shared_.counting->bring_in(number_, static_cast<std::size_t>(line.key >> 32U), line.unit);
  }
  (void)ask_for_line(line.key, {line.unit, line.kind}, true);
}

// Takes a register for a line that the cache has not held until now, and asks for it behind the cache.
std::uint32_t SimtNode::ask_for_line(LineRegisters::Key key, const LineRead& line, bool prefetched) {
  const std::optional<sim::Ticks> hit = shared_.behind.second_level_hit(number_, line.unit);
  const std::uint32_t number = registers_.take(key, !hit, prefetched, cycle_);
  registers_[number].kind = line.kind;
  registers_[number].origin = line.origin;
  const machine::MachineConfig& config = shared_.input.config;
  if (hit) {
    if (shared_.counting && !prefetched) {
      shared_.counting->second_level_hit(line.kind, line.origin);
    }
    queue_.push(cycle_ + std::max<std::int64_t>(1, shared_.cycle_at(*hit)), {Due::line, number});
  } else if (shared_.behind.reads_alone()) {
    sim::Ticks time = config.clock.cycles(cycle_);
    cost::TimeDivision unused{};
    arrives(number, shared_.behind.read(config.reference_bytes(), time, unused), cycle_);
  } else {
    reads.push_back({number, memory::Address{line.unit} << shared_.unit_shift, config.reference_bytes()});
  }
  return number;
}

void SimtNode::count_pending(std::uint32_t waiter, bool left) {
  if ((waiter & phase_bit) != 0) {
    Warp& warp = warps_[waiter & ~phase_bit];
    ++warp.pending;
    warp.left += left ? 1 : 0;
    refresh_phase(waiter & ~phase_bit);
  } else {
    Access& access = accesses_[waiter];
    ++access.pending;
    access.left += left ? 1 : 0;
  }
}

void SimtNode::line_there(std::uint32_t waiter, bool left) {
  if ((waiter & phase_bit) != 0) {
    const std::uint32_t number = waiter & ~phase_bit;
    Warp& warp = warps_[number];
    --warp.pending;
    warp.left -= left ? 1 : 0;
    if (warp.computing == Computing::reads && warp.pending == 0 && warp.next_line == warp.lines.size()) {
      ask_for_slot(number);
    }
    refresh_phase(number);
    touched_ |= std::uint64_t{1} << number;
    return;
  }
  Access& access = accesses_[waiter];
  --access.pending;
  access.left -= left ? 1 : 0;
  if (!access.sent) {
    return;
  }
  if (access.pending == 0) {
    completed_.push_back(waiter);
  } else if (left && access.left == 0) {
    place_access(access, LaneState::cache);
  }
}

void SimtNode::arrives(std::uint32_t number, const memory::Service& service, std::int64_t known) {
  const std::int64_t there = shared_.cycle_at(service.done);
  queue_.push(std::max({there, registers_[number].asked + 1, known + 1}), {Due::line, number});
  last_arrival_ = std::max(last_arrival_, service.done);
  if (shared_.counting && !registers_[number].prefetched) {
    shared_.counting->wait(registers_[number].kind, registers_[number].origin, service);
  }
  read_parts_[0] += service.wait_interconnect;
  read_parts_[1] += service.transfer;
  read_parts_[2] += service.wait_bank;
  read_parts_[3] += service.bank;
}

std::size_t SimtNode::bytes() const {
  return sizeof(SimtNode) + warps_.size() * sizeof(Warp) + lanes_.size() * sizeof(Lane) +
         stacks_.size() * sizeof(LaneStack) +
         shared_lanes_.size() * (sizeof(SharedLane) + sizeof(SharedRay)) +
         spilled_stacks_.size() * sizeof(SpilledStack);
}

}  // namespace marti::processors::simt
