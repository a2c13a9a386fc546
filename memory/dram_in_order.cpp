#include "memory/dram_in_order.h"

#include <algorithm>
#include <limits>

namespace marti::memory {

DramInOrder::DramInOrder(const DramConfig& config)
    : timing_(config.timing),
      period_(config.period),
      burst_time_(config.burst_time()),
      ranks_(config.ranks),
      burst_bytes_(config.burst_bytes),
      column_cycles_(config.column_cycles),
      activate_cycles_(config.activate_cycles),
      two_command_buses_(config.two_command_buses),
      close_(config.page == DramPage::closed),
      device_(config),
      refresh_due_(config.timing.refi > 0 ? config.timing.refi : std::numeric_limits<DramCycle>::max()) {}

DramService DramInOrder::serve(const DramRequest& request) {
  DramService service;
  for (std::int64_t i = 0; i < request.bursts; ++i) {
    const Issued issued = burst(request, i + 1 == request.bursts);
    if (i == 0) {
      service.first = issued.first;
    }
  }
  service.end = device_.end_of_data(request.write ? DramCommand::write : DramCommand::read, last_column_);
  (request.write ? statistics_.write_bursts : statistics_.read_bursts) += request.bursts;
  statistics_.bytes += request.bursts * burst_bytes_;
  statistics_.data_busy =
      sim::add_ticks(statistics_.data_busy, sim::multiply_ticks(burst_time_, request.bursts));
  statistics_.queued = sim::add_ticks(statistics_.queued, period_ * (last_column_ - request.arrival));
  return service;
}

DramInOrder::Issued DramInOrder::burst(const DramRequest& request, bool last) {
  DramCycle from = std::max(prepared_, request.arrival + 1);
  Issued issued;
  bool begun = false;
  bool opened = false;
  for (;;) {
    const DramCommand command = device_.next_command(request.place, request.write);
    const bool column = command == DramCommand::read || command == DramCommand::write;
    DramCycle cycle = std::max(from, device_.earliest(command, request.place));
    const DramCycle length = command == DramCommand::activate ? activate_cycles_
                             : column                         ? column_cycles_
                                                              : 1;
    cycle = column ? std::max(cycle, last_column_ + length) : free_slot(cycle, length);
    if (cycle >= refresh_due_ && !opened) {
      const DramCycle due = refresh_due_;
      refresh(cycle);
      // What the refresh costs this access: until its row may be opened again.
      const DramCycle again = device_.earliest(DramCommand::activate, request.place);
      statistics_.refresh_stall += period_ * std::max<DramCycle>(0, again - std::max(cycle, due));
      from = std::max(from, prepared_);
      continue;
    }
    if (!begun) {
      begun = true;
      issued.first = cycle;
      ++(column                             ? statistics_.row_hits
         : command == DramCommand::activate ? statistics_.row_misses
                                            : statistics_.row_conflicts);
    }
    device_.issue(command, request.place, cycle, column && close_ && last);
    if (column) {
      prepared_ = opened ? prepared_ : cycle + (two_command_buses_ ? 0 : length);
      last_column_ = cycle;
      columns_.push_back(cycle);
      while (!columns_.empty() && columns_.front() + column_cycles_ <= prepared_) {
        columns_.pop_front();
      }
      issued.column = cycle;
      return issued;
    }
    from = cycle + length;
    if (command == DramCommand::activate) {
      ++statistics_.activations;
      opened = true;
      prepared_ = from;
    }
  }
}

DramCycle DramInOrder::free_slot(DramCycle cycle, DramCycle length) const {
  if (!two_command_buses_) {
    for (const DramCycle taken : columns_) {
      if (taken < cycle + length && cycle < taken + column_cycles_) {
        cycle = taken + column_cycles_;
      }
    }
  }
  return cycle;
}

void DramInOrder::refresh(DramCycle cycle) {
  // While nothing is asked for, each refresh begins when it is due: only the last one matters.
  const std::int64_t more = (cycle - refresh_due_) / timing_.refi;
  const DramCycle last = refresh_due_ + more * timing_.refi;
  const bool idle = last >= std::max(last_column_, last_refresh_) + device_.settling();
  DramCycle end = std::max(last_column_ + (two_command_buses_ ? 0 : column_cycles_), prepared_);
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    if (idle) {
      last_refresh_ = device_.refresh_idle(rank, std::max(last, end), more > 0);
    } else {
      DramCycle start = std::max(refresh_due_, end);
      if (device_.has_open_row(rank)) {
        start = std::max(start, device_.earliest_precharge_all(rank));
        device_.precharge_all(rank, start);
      }
      last_refresh_ = std::max(start, device_.earliest_refresh(rank));
      device_.refresh(rank, last_refresh_);
    }
    end = last_refresh_ + 1;
  }
  prepared_ = end;
  const std::int64_t done = idle ? more + 1 : 1;
  statistics_.refreshes += done * ranks_;
  refresh_due_ += done * timing_.refi;
}

}  // namespace marti::memory
