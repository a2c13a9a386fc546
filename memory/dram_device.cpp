#include "memory/dram_device.h"

#include <limits>

namespace marti::memory {

namespace {

// Long before any cycle, yet far from an overflow.
constexpr DramCycle long_ago = std::numeric_limits<DramCycle>::min() / 4;

}  // namespace

DramDevice::DramDevice(const DramConfig& config)
    : timing_(config.timing_of_commands()),
      lengths_(config.command_steps()),
      refresh_later_(lengths_.activate - lengths_.precharge),
      settling_(std::max({timing_.rc, timing_.ras + timing_.rp, timing_.rtp + timing_.rp, timing_.rfc,
                          timing_.cwl + timing_.bl + timing_.wr + timing_.rp, timing_.ppd}) +
                refresh_later_),
      one_data_bus_(!config.pseudo_channels),
      one_command_bus_(!config.two_command_buses),
      refresh_after_precharge_(config.refresh_after_precharge),
      banks_of_rank_(config.banks_of_rank()),
      stacks_of_rank_(config.stacks),
      banks_(std::size_t{config.ranks} * config.banks_of_rank()),
      groups_(std::size_t{config.ranks} * config.stacks * config.bank_groups),
      stacks_(std::size_t{config.ranks} * config.stacks),
      ranks_(config.ranks) {
  for (Rank& rank : ranks_) {
    rank.activations.fill(long_ago);
  }
}

void DramDevice::issue(DramCommand command, const DramPlace& place, DramCycle cycle, bool close) {
  Bank& bank = banks_[place.bank];
  switch (command) {
    case DramCommand::activate:
      issue_activate(place, cycle);
      bank.row = place.row;
      return;
    case DramCommand::precharge:
      raise(of(bank.next, DramCommand::activate), cycle + timing_.rp);
      raise(of(ranks_[place.rank].next, DramCommand::precharge), cycle + timing_.ppd);
      if (refresh_after_precharge_) {
        raise(ranks_[place.rank].refresh, cycle + timing_.rp + refresh_later_);
      }
      bank.row = no_row;
      return;
    case DramCommand::read:
    case DramCommand::write:
      issue_column(command, place, cycle);
      if (close) {
        // The device closes the row by itself, after this access and the writes before it. How long the row
        // was open is in the time between two activations of the bank.
        raise(of(bank.next, DramCommand::activate), bank.recovered + timing_.rp);
        raise(ranks_[place.rank].refresh, bank.recovered + timing_.rp + refresh_later_);
        bank.row = no_row;
      }
      return;
  }
}

void DramDevice::issue(const Course& course, const DramPlace& place, bool write, bool close) {
  if (course.precharge >= 0) {
    issue(DramCommand::precharge, place, course.precharge);
  }
  if (course.activate >= 0) {
    issue(DramCommand::activate, place, course.activate);
  }
  issue(write ? DramCommand::write : DramCommand::read, place, course.column, close);
}

void DramDevice::issue_activate(const DramPlace& place, DramCycle cycle) {
  Times& bank = banks_[place.bank].next;
  raise(of(bank, DramCommand::read), cycle + timing_.rcd);
  raise(of(bank, DramCommand::write), cycle + timing_.rcd_write);
  raise(of(bank, DramCommand::precharge), cycle + timing_.ras);
  raise(of(bank, DramCommand::activate), cycle + timing_.rc);
  raise(of(groups_[place.group], DramCommand::activate), cycle + timing_.rrd_l);
  Rank& rank = ranks_[place.rank];
  raise(of(rank.next, DramCommand::activate), cycle + timing_.rrd_s);
  raise(rank.precharge_all, cycle + timing_.ras);
  raise(rank.refresh, cycle + timing_.rc + refresh_later_);
  // The fifth activation from here must wait for the end of the window that begins with this one.
  rank.activations[rank.oldest] = cycle + timing_.faw;
  rank.oldest = (rank.oldest + 1) % 4;
}

void DramDevice::issue_column(DramCommand command, const DramPlace& place, DramCycle cycle) {
  Bank& bank = banks_[place.bank];
  Times& group = groups_[place.group];
  const bool write = command == DramCommand::write;
  const DramCommand other = write ? DramCommand::read : DramCommand::write;
  raise(of(group, command), cycle + (write ? timing_.ccd_l_write : timing_.ccd_l));
  const DramCycle end = end_of_data(command, cycle);
  // Data written must not come before data read have left the bus.
  const DramCycle turn_read_to_write = timing_.cl + timing_.bl + timing_.rtw_gap - timing_.cwl;
  if (write) {
    raise(of(group, other), end + timing_.wtr_l);
  }
  raise(bank.recovered, write ? end + timing_.wr : cycle + timing_.rtp);
  raise(of(bank.next, DramCommand::precharge), bank.recovered);
  if (!write) {
    for (std::uint32_t i = place.rank * stacks_of_rank_; i < (place.rank + 1) * stacks_of_rank_; ++i) {
      raise(stacks_[i], i == place.stack ? 0 : cycle + timing_.ccd_stack);
    }
  }
  for (std::size_t i = 0; i < ranks_.size(); ++i) {
    Times& rank = ranks_[i].next;
    if (i == place.rank) {
      raise(of(rank, command), cycle + timing_.ccd_s);
      raise(of(rank, other), write ? end + timing_.wtr_s : cycle + turn_read_to_write);
      continue;
    }
    if (one_data_bus_) {
      // Another rank's data must not come before the bus is free again.
      const DramCycle free = end + timing_.rank_gap;
      raise(of(rank, DramCommand::read), free - timing_.cl);
      raise(of(rank, DramCommand::write), free - timing_.cwl);
    }
  }
}

DramDevice::Course DramDevice::course(const DramPlace& place, bool write, DramCycle row,
                                      DramCycle column) const {
  const DramCommand moving = write ? DramCommand::write : DramCommand::read;
  Course course;
  course.column = std::max(column, earliest(moving, place));
  if (banks_[place.bank].row == place.row) {
    return course;
  }
  course.activate = std::max(row, earliest(DramCommand::activate, place));
  if (banks_[place.bank].row != no_row) {
    course.precharge = std::max(row, earliest(DramCommand::precharge, place));
    raise(course.activate, course.precharge + std::max(timing_.rp, bus_cycles(DramCommand::precharge)));
  }
  raise(course.column, course.activate + (write ? timing_.rcd_write : timing_.rcd));
  // With a command bus of their own, reads and writes of a cycle come before what opens rows in it.
  raise(course.column, course.activate + (one_command_bus_ ? bus_cycles(DramCommand::activate) : 1));
  return course;
}

bool DramDevice::has_open_row(std::uint32_t rank) const {
  const auto first = banks_.begin() + std::ptrdiff_t{rank} * banks_of_rank_;
  return std::any_of(first, first + banks_of_rank_, [](const Bank& bank) { return bank.row != no_row; });
}

DramCycle DramDevice::earliest_precharge_all(std::uint32_t rank) const {
  // The command is one for all banks, so it waits for activations of banks that are closed again, too.
  DramCycle cycle = std::max(ranks_[rank].precharge_all, of(ranks_[rank].next, DramCommand::precharge));
  for (std::uint32_t i = rank * banks_of_rank_; i < (rank + 1) * banks_of_rank_; ++i) {
    if (banks_[i].row != no_row) {
      raise(cycle, of(banks_[i].next, DramCommand::precharge));
    }
  }
  return cycle;
}

void DramDevice::precharge_all(std::uint32_t rank, DramCycle cycle) {
  raise(of(ranks_[rank].next, DramCommand::precharge), cycle + timing_.ppd);
  raise(ranks_[rank].refresh, cycle + timing_.rp + refresh_later_);
  for (std::uint32_t i = rank * banks_of_rank_; i < (rank + 1) * banks_of_rank_; ++i) {
    if (banks_[i].row != no_row) {
      raise(of(banks_[i].next, DramCommand::activate), cycle + timing_.rp);
      banks_[i].row = no_row;
    }
  }
}

DramCycle DramDevice::refresh_idle(std::uint32_t rank, DramCycle cycle, bool closed) {
  const DramCycle start =
      closed || !has_open_row(rank) ? cycle : cycle + std::max<DramCycle>(1, timing_.rp + refresh_later_);
  for (std::uint32_t i = rank * banks_of_rank_; i < (rank + 1) * banks_of_rank_; ++i) {
    banks_[i].row = no_row;
    of(banks_[i].next, DramCommand::activate) = start + timing_.rfc;
  }
  ranks_[rank].refresh = start + timing_.rfc + refresh_later_;
  return start;
}

void DramDevice::refresh(std::uint32_t rank, DramCycle cycle) {
  raise(ranks_[rank].refresh, cycle + timing_.rfc + refresh_later_);
  for (std::uint32_t i = rank * banks_of_rank_; i < (rank + 1) * banks_of_rank_; ++i) {
    raise(of(banks_[i].next, DramCommand::activate), cycle + timing_.rfc);
  }
}

}  // namespace marti::memory
