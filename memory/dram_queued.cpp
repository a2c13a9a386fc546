#include "memory/dram_queued.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::memory {

DramQueued::DramQueued(const DramConfig& config)
    : steps_(config.steps()),
      refi_(config.timing_of_commands().refi),
      rfc_(config.timing_of_commands().rfc),
      period_(config.period),
      burst_time_(config.period * config.timing.bl),
      ranks_(config.ranks),
      burst_bytes_(config.burst_bytes),
      queue_(config.queue),
      cap_(config.reorder_cap),
      two_command_buses_(config.two_command_buses),
      close_(config.page == DramPage::closed),
      second_within_(config.second_activation),
      clock_tail_(config.data_clock_tail),
      device_(config),
      buses_(config),
      // With half cycles a refresh falls due half a cycle early.
      refresh_due_(refi_ > 0 ? refi_ + 1 - steps_ : never) {}

std::optional<DramDone> DramQueued::enter(const DramRequest& request, Address address, std::uint64_t tag,
                                          sim::Ticks known) {
  sim::ensure(request.arrival >= now_, "an access reaches a DRAM channel after a later command");
  if (idle()) {
    catch_up(request.arrival);
    if (request.bursts == 1 && steps_ == 1 && second_within_ == 0 && clock_tail_ == 0) {
      if (const std::optional<DramDone> done = serve_alone(request, tag, known)) {
        return done;
      }
    }
  }
  if (!request.write && waits_to_be_written(request, address)) {
    ++statistics_.forwarded;
    return DramDone{tag, {request.arrival + steps_, request.arrival + steps_}};
  }
  settle(request.arrival, true);
  std::uint32_t place = 0;
  if (unused_.empty()) {
    place = static_cast<std::uint32_t>(accesses_.size());
    accesses_.emplace_back();
  } else {
    place = unused_.back();
    unused_.pop_back();
  }
  accesses_[place] = {tag, request.arrival, {}, request.bursts};
  for (std::int64_t i = 0; i < request.bursts; ++i) {
    Burst burst;
    burst.place = request.place;
    burst.address = address + static_cast<Address>(i) * burst_bytes_;
    burst.order = entered_++;
    burst.access = place;
    burst.write = request.write;
    if (burst.write) {
      unwritten_.insert(burst.address);
    }
    burst.line = address;
    burst.alone = request.bursts == 1;
    before_.push_back(burst);
  }
  // What arrives in a cycle can have a command in the next one at the earliest.
  next_column_ = std::max(next_column_, request.arrival + 1);
  next_row_ = std::max(next_row_, request.arrival + 1);
  fill();
  next_.reset();
  return std::nullopt;
}

std::optional<DramDone> DramQueued::serve_alone(const DramRequest& request, std::uint64_t tag,
                                                sim::Ticks known) {
  const DramCycle from = request.arrival + 1;
  const DramDevice::Course course =
      device_.course(request.place, request.write, std::max(next_row_, from), std::max(next_column_, from));
  if (course.column >= refresh_due_ || sim::multiply_ticks(period_, course.column - 1) >= known) {
    return std::nullopt;
  }
  device_.issue(course, request.place, request.write, close_);
  const DramCommand moving = request.write ? DramCommand::write : DramCommand::read;
  if (course.activate >= 0) {
    use_slot(DramCommand::activate, course.activate);
    ++statistics_.activations;
  }
  use_slot(moving, course.column);
  count_start(request.arrival, course.first_command(request.write), course.first());
  statistics_.count_moved(request.write, 1, burst_bytes_, burst_time_);
  buses_.moved({request.place.rank, request.arrival, request.arrival,
                device_.open_from(request.place, request.write), course.column,
                device_.end_of_data(moving, course.column)});
  count_queued(request.arrival, course.column);
  now_ = course.column;
  // As step() leaves it, which decides anew at each command by what waits before it.
  writing_ =
      request.write || two_command_buses_ || (course.activate >= 0 && course.activate + 1 < course.column);
  return DramDone{tag, {course.first(), device_.end_of_data(moving, course.column)}};
}

bool DramQueued::waits_to_be_written(const DramRequest& request, Address address) const {
  for (std::int64_t i = 0; i < request.bursts && !unwritten_.empty(); ++i) {
    if (!unwritten_.contains(address + static_cast<Address>(i) * burst_bytes_)) {
      return false;
    }
  }
  return !unwritten_.empty();
}

void DramQueued::fill() {
  while (!before_.empty()) {
    std::vector<Burst>& queue = before_.front().write ? writes_ : reads_;
    if (queue.size() >= queue_) {
      return;
    }
    queue.push_back(before_.front());
    before_.pop_front();
  }
}

void DramQueued::settle(DramCycle cycle, bool asked) {
  if (now_ < cycle) {
    fill();
    const DramCycle first = std::max(now_, clock_started_) + 1;
    if (first <= cycle && first < refresh_due_ && (asked || first < cycle)) {
      writing_ = write_mode();
    }
    now_ = cycle;
  }
}

bool DramQueued::write_mode() const {
  const std::size_t fifths = 5 * writes_.size();
  return writing_ ? fifths >= queue_ || reads_.empty() : fifths > 4 * queue_ || reads_.empty();
}

void DramQueued::pick_among(const std::vector<Burst>& bursts, Kind kind, DramCycle from, Pick& best) const {
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    const Burst& burst = bursts[i];
    const DramCommand command = device_.next_command(burst.place, burst.write);
    const bool blocked =
        (kind == Kind::queue && command == DramCommand::precharge && in_use(burst.place.bank)) ||
        (command == DramCommand::activate && activating_);
    if (!blocked) {
      const DramCycle cycle = std::max({from, slot(command), device_.earliest(command, burst.place)});
      const Pick pick{command == DramCommand::precharge ? cycle : whole(cycle), kind, command, i};
      if (goes_first(pick, best)) {
        best = pick;
      }
    }
    if (kind == Kind::queue && cap_ > 0 && burst.passed >= cap_) {
      return;
    }
  }
}

bool DramQueued::in_use(std::uint32_t bank) const {
  return (activating_ && activating_->place.bank == bank) ||
         std::any_of(active_.begin(), active_.end(),
                     [&](const Burst& burst) { return burst.place.bank == bank; });
}

void DramQueued::pick_refresh(Pick& best) const {
  const auto of_the_rank = [&](const Burst& burst) { return burst.place.rank == refresh_rank_; };
  if ((activating_ && of_the_rank(*activating_)) ||
      std::any_of(active_.begin(), active_.end(), of_the_rank)) {
    return;
  }
  const bool open = device_.has_open_row(refresh_rank_);
  const DramCycle allowed =
      open ? device_.earliest_precharge_all(refresh_rank_) : device_.earliest_refresh(refresh_rank_);
  const DramCycle first = std::max({allowed, next_row_, refresh_due_});
  const DramCycle cycle = open ? first : whole(first);
  if (cycle < best.cycle) {
    best = {cycle, open ? Kind::precharge_all : Kind::refresh, DramCommand::precharge, 0};
  }
}

DramQueued::Pick DramQueued::pick() const {
  const Pick other = pick_other();
  if (!activating_) {
    return other;
  }
  const DramCycle free = std::max(now_, next_row_);
  const bool starts_the_clock = is_column(other.command) && other.cycle >= clock_stops_ && clock_tail_ > 0;
  const bool last = second_by_ <= free || (starts_the_clock && second_by_ <= free + 1);
  return other.cycle > free || last ? Pick{free, Kind::second_activation, DramCommand::activate, 0} : other;
}

DramQueued::Pick DramQueued::pick_other() const {
  Pick best;
  pick_among(active_, Kind::active, now_, best);
  Pick queued;
  pick_among(writing_ ? writes_ : reads_, Kind::queue, now_, queued);
  if (queued.cycle > now_ && write_mode() != writing_) {
    queued = {};
    pick_among(writing_ ? reads_ : writes_, Kind::queue, now_ + 1, queued);
  }
  if (goes_first(queued, best) && queued.cycle < refresh_due_) {
    return queued;
  }
  if (refresh_due_ < best.cycle) {
    pick_refresh(best);
  }
  return best;
}

DramCycle DramQueued::next() {
  if (idle()) {
    return never;
  }
  if (!next_) {
    next_ = pick();
    if (next_->cycle > now_ && !before_.empty()) {
      fill();
      next_column_ = std::max(next_column_, now_ + 1);
      next_row_ = std::max(next_row_, now_ + 1);
      next_ = pick();
    }
  }
  return next_->cycle;
}

std::optional<DramDone> DramQueued::step() {
  const DramCycle cycle = next();
  sim::ensure(cycle != never, "a DRAM channel without an access has no next command");
  const Pick pick = *next_;
  next_.reset();
  settle(cycle, two_command_buses_ ||
                    (pick.kind == Kind::second_activation ? cycle < second_by_ : pick.kind != Kind::active));
  std::optional<DramDone> done;
  if (pick.kind == Kind::second_activation) {
    use_slot(DramCommand::activate, cycle);
    make_active(*activating_);
    activating_.reset();
  } else if (pick.kind == Kind::active) {
    done = issue(active_, pick);
  } else if (pick.kind == Kind::queue) {
    done = issue(writing_ ? writes_ : reads_, pick);
  } else {
    issue_refresh(pick);
  }
  if (!two_command_buses_) {
    fill();
  } else if (pick.kind == Kind::queue && is_column(pick.command)) {
    writing_ = write_mode();  // before the cycle's command that opens or closes a row is chosen
  }
  return done;
}

void DramQueued::use_slot(DramCommand command, DramCycle cycle) {
  const DramCycle free = cycle + device_.bus_cycles(command);
  if (!two_command_buses_) {
    next_column_ = next_row_ = free;
  } else if (is_column(command)) {
    next_column_ = free;
  } else {
    next_row_ = free;
    // A cycle's read or write is chosen first.
    next_column_ = std::max(next_column_, cycle + 1);
  }
}

void DramQueued::count_start(DramCycle arrival, DramCommand command, DramCycle cycle) {
  count_first(statistics_, command);
  if (stall_begin_ != never) {
    const DramCycle begin = std::max(stall_begin_, arrival);
    statistics_.refresh_stall +=
        period_ * std::max<DramCycle>(0, std::min(stall_end_, cycle) - begin) / steps_;
    stall_begin_ = never;
  }
}

DramCycle DramQueued::asked_for_bus(std::uint32_t rank, DramCycle arrival) const {
  const auto on_the_bus = [&](const Burst& burst) {
    return buses_.bus_of(burst.place.rank) == buses_.bus_of(rank);
  };
  // Each list is in the order of arrival.
  const auto look = [&](const auto& bursts) {
    const auto first = std::find_if(bursts.begin(), bursts.end(), on_the_bus);
    if (first != bursts.end()) {
      arrival = std::min(arrival, accesses_[first->access].arrival);
    }
  };
  look(reads_);
  look(writes_);
  look(active_);
  look(before_);
  if (activating_ && on_the_bus(*activating_)) {
    arrival = std::min(arrival, accesses_[activating_->access].arrival);
  }
  return arrival;
}

void DramQueued::count_queued(DramCycle arrival, DramCycle last) {
  statistics_.queued += period_ * (last - arrival) / steps_;
}

void DramQueued::make_active(const Burst& burst) {
  const auto older = [](const Burst& a, const Burst& b) { return a.order < b.order; };
  active_.insert(std::upper_bound(active_.begin(), active_.end(), burst, older), burst);
}

std::optional<DramDone> DramQueued::issue(std::vector<Burst>& from, const Pick& pick) {
  const bool column = is_column(pick.command);
  const bool starts_the_clock = column && clock_tail_ > 0 && pick.cycle >= clock_stops_;
  const DramCycle cycle = pick.cycle + (starts_the_clock ? 1 : 0);
  clock_started_ = starts_the_clock ? cycle : clock_started_;
  use_slot(pick.command, cycle);
  Burst& burst = from[pick.index];
  if (!burst.begun) {
    burst.begun = true;
    Access& access = accesses_[burst.access];
    access.service.first = access.service.first == 0 ? cycle : access.service.first;
    count_start(access.arrival, pick.command, cycle);
  }
  // A read or write behind the command that starts the data clock leaves its row open, as in Ramulator.
  device_.issue(pick.command, burst.place, cycle, column && close_ && !starts_the_clock && closes_row(burst));
  statistics_.activations += pick.command == DramCommand::activate ? 1 : 0;
  if (pick.command == DramCommand::precharge || (pick.kind == Kind::active && !column)) {
    return std::nullopt;
  }
  const Burst leaving = burst;
  from.erase(from.begin() + static_cast<std::ptrdiff_t>(pick.index));
  if (pick.kind == Kind::queue) {
    for (std::size_t i = 0; i < pick.index; ++i) {
      ++from[i].passed;
    }
  }
  if (!column) {
    if (second_within_ > 0) {
      activating_ = leaving;
      second_by_ = cycle + second_within_;
    } else {
      make_active(leaving);
    }
    return std::nullopt;
  }
  clock_stops_ = std::max(clock_stops_, device_.end_of_data(pick.command, cycle) + clock_tail_);
  if (leaving.write) {
    unwritten_.erase(unwritten_.find(leaving.address));
  }
  statistics_.count_moved(leaving.write, 1, burst_bytes_, burst_time_);
  Access& access = accesses_[leaving.access];
  buses_.moved({leaving.place.rank, access.arrival, asked_for_bus(leaving.place.rank, access.arrival),
                device_.open_from(leaving.place, leaving.write), cycle,
                device_.end_of_data(pick.command, cycle)});
  access.service.end = std::max(access.service.end, device_.end_of_data(pick.command, cycle));
  if (--access.left > 0) {
    return std::nullopt;
  }
  count_queued(access.arrival, cycle);
  unused_.push_back(leaving.access);
  return DramDone{access.tag, access.service};
}

bool DramQueued::closes_row(const Burst& burst) const {
  const auto of_this_line = [&](const std::vector<Burst>& bursts) {
    return std::any_of(bursts.begin(), bursts.end(), [&](const Burst& other) {
      return other.line == burst.line && other.order != burst.order && !other.alone;
    });
  };
  return burst.alone || !(of_this_line(active_) || of_this_line(reads_) || of_this_line(writes_));
}

void DramQueued::issue_refresh(const Pick& pick) {
  use_slot(pick.command, pick.cycle);
  if (pick.kind == Kind::precharge_all) {
    device_.precharge_all(refresh_rank_, pick.cycle);
    return;
  }
  device_.refresh(refresh_rank_, pick.cycle);
  last_refresh_ = pick.cycle;
  buses_.refreshed(refresh_rank_, refresh_due_, pick.cycle + rfc_);
  ++statistics_.refreshes;
  if (++refresh_rank_ == ranks_) {
    stall_begin_ = refresh_due_;
    stall_end_ = pick.cycle + rfc_;
    refresh_rank_ = 0;
    refresh_due_ += refi_;
  }
}

void DramQueued::catch_up(DramCycle cycle) {
  while (refresh_due_ <= cycle) {
    // While nothing is asked for, each refresh begins when it is due: only the last one matters.
    const auto [more, last] = device_.due_refreshes(refresh_due_, cycle);
    const DramCycle before = std::max({now_, next_row_, last_refresh_});
    if (more > 0 && refresh_rank_ == 0 && last >= before + device_.settling()) {
      for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
        last_refresh_ = device_.refresh_idle(rank, whole(last) + rank * steps_, true);
        buses_.refreshed(rank, last, last_refresh_ + rfc_);
      }
      next_row_ = last_refresh_ + 1;
      next_column_ = two_command_buses_ ? next_column_ : next_row_;
      statistics_.refreshes += (more + 1) * ranks_;
      stall_begin_ = last;
      stall_end_ = last_refresh_ + rfc_;
      refresh_due_ = last + refi_;
      return;
    }
    Pick refresh;
    pick_refresh(refresh);
    if (refresh.cycle > cycle) {
      return;
    }
    issue_refresh(refresh);
  }
}

}  // namespace marti::memory
