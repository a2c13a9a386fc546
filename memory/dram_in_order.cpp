#include "memory/dram_in_order.h"

#include <algorithm>
#include <limits>

namespace marti::memory {

DramInOrder::DramInOrder(const DramConfig& config)
    : refi_(config.timing.refi),
      rfc_(config.timing_of_commands().rfc),
      period_(config.period),
      burst_time_(config.period * config.timing.bl),
      ranks_(config.ranks),
      burst_bytes_(config.burst_bytes),
      column_cycles_(config.command_steps().column),
      two_command_buses_(config.two_command_buses),
      close_(config.page == DramPage::closed),
      device_(config),
      buses_(config),
      refresh_due_(config.timing.refi > 0 ? config.timing.refi : std::numeric_limits<DramCycle>::max()) {}

DramService DramInOrder::serve(const DramRequest& request) {
  DramService service;
  for (std::int64_t i = 0; i < request.bursts; ++i) {
    const DramCycle first = burst(request, i + 1 == request.bursts);
    if (i == 0) {
      service.first = first;
    }
  }
  service.end = device_.end_of_data(request.write ? DramCommand::write : DramCommand::read, last_column_);
  statistics_.count_moved(request.write, request.bursts, burst_bytes_, burst_time_);
  statistics_.queued += period_ * (last_column_ - request.arrival);
  return service;
}

DramCycle DramInOrder::burst(const DramRequest& request, bool last) {
  DramCycle from = std::max(prepared_, request.arrival + 1);
  if (!columns_.empty() && columns_.back() + column_cycles_ > from) {
    return burst_by_commands(request, last, from);
  }
  for (;;) {
    const DramCycle column = std::max(from, last_column_ + column_cycles_);
    const DramDevice::Course course = device_.course(request.place, request.write, from, column);
    if (course.column < refresh_due_) {
      device_.issue(course, request.place, request.write, close_ && last);
      count_first(statistics_, course.first_command(request.write));
      if (course.activate >= 0) {
        ++statistics_.activations;
        prepared_ = course.activate + device_.bus_cycles(DramCommand::activate);
      }
      end_burst(request, course.column, course.activate >= 0);
      return course.first();
    }
    if (course.first() < refresh_due_) {
      return burst_by_commands(request, last, from);
    }
    from = refresh_before(request, course.first(), from);
  }
}

DramCycle DramInOrder::burst_by_commands(const DramRequest& request, bool last, DramCycle from) {
  DramCycle first = 0;
  bool begun = false;
  bool opened = false;
  for (;;) {
    const DramCommand command = device_.next_command(request.place, request.write);
    const bool column = is_column(command);
    DramCycle cycle = std::max(from, device_.earliest(command, request.place));
    const DramCycle length = device_.bus_cycles(command);
    cycle = column ? std::max(cycle, last_column_ + length) : free_slot(cycle, length);
    if (cycle >= refresh_due_ && !opened) {
      from = refresh_before(request, cycle, from);
      continue;
    }
    if (!begun) {
      begun = true;
      first = cycle;
      count_first(statistics_, command);
    }
    device_.issue(command, request.place, cycle, column && close_ && last);
    if (column) {
      end_burst(request, cycle, opened);
      return first;
    }
    from = cycle + length;
    if (command == DramCommand::precharge) {
      last_precharge_ = cycle;
    } else {
      ++statistics_.activations;
      opened = true;
      prepared_ = from;
      // Where reads and writes have a command bus of their own, only the device holds them back.
      from = two_command_buses_ ? cycle + 1 : from;
    }
  }
}

DramCycle DramInOrder::refresh_before(const DramRequest& request, DramCycle cycle, DramCycle from) {
  refresh(cycle);
  // What the refresh costs this access: until its row may be opened again.
  const DramCycle again = device_.earliest(DramCommand::activate, request.place);
  statistics_.refresh_stall += period_ * std::max<DramCycle>(0, again - cycle);
  return std::max(from, prepared_);
}

void DramInOrder::end_burst(const DramRequest& request, DramCycle column, bool opened) {
  last_column_ = column;
  buses_.moved({request.place.rank, request.arrival, request.arrival,
                device_.open_from(request.place, request.write), column,
                device_.end_of_data(request.write ? DramCommand::write : DramCommand::read, column)});
  if (two_command_buses_) {
    prepared_ = opened ? prepared_ : column;
    return;
  }
  prepared_ = opened ? prepared_ : column + column_cycles_;
  std::size_t past = 0;
  while (past < columns_.size() && columns_[past] + column_cycles_ <= prepared_) {
    ++past;
  }
  if (past == columns_.size()) {
    columns_.clear();
  } else if (past > 0) {
    columns_.erase(columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(past));
  }
  if (column + column_cycles_ > prepared_) {
    columns_.push_back(column);
  }
}

DramCycle DramInOrder::free_slot(DramCycle cycle, DramCycle length) const {
  for (const DramCycle taken : columns_) {
    if (taken < cycle + length && cycle < taken + column_cycles_) {
      cycle = taken + column_cycles_;
    }
  }
  return cycle;
}

void DramInOrder::refresh(DramCycle cycle) {
  // While nothing is asked for, each refresh begins when it is due: only the last one matters.
  const auto [more, last] = device_.due_refreshes(refresh_due_, cycle);
  const bool idle = last >= std::max({last_column_, last_precharge_, last_refresh_}) + device_.settling();
  const DramCycle due = idle ? last : refresh_due_;
  DramCycle end = std::max(last_column_ + (two_command_buses_ ? 0 : column_cycles_), prepared_);
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    if (idle) {
      last_refresh_ = device_.refresh_idle(rank, std::max(last, end), more > 0);
    } else {
      DramCycle start = std::max(refresh_due_, end);
      if (device_.has_open_row(rank)) {
        start = std::max(start, device_.earliest_precharge_all(rank));
        device_.precharge_all(rank, start);
        ++start;
      }
      last_refresh_ = std::max(start, device_.earliest_refresh(rank));
      device_.refresh(rank, last_refresh_);
    }
    buses_.refreshed(rank, due, last_refresh_ + rfc_);
    end = last_refresh_ + 1;
  }
  prepared_ = end;
  const std::int64_t done = idle ? more + 1 : 1;
  statistics_.refreshes += done * ranks_;
  refresh_due_ += done * refi_;
}

}  // namespace marti::memory
