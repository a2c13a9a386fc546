// The banks of one DRAM channel: which rows are open, and from when each command is allowed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "memory/dram_config.h"
#include "memory/dram_mapping.h"
#include "memory/dram_statistics.h"

namespace marti::memory {

/// A time in steps of the DRAM's clock: cycles, or halves of them (DramConfig::steps()).
using DramCycle = std::int64_t;

enum class DramCommand : std::uint8_t { activate, precharge, read, write };

/// Whether a command moves data.
[[nodiscard]] constexpr bool is_column(DramCommand command) {
  return command == DramCommand::read || command == DramCommand::write;
}

/// Counts what a burst finds whose first command this is.
inline void count_first(DramStatistics& statistics, DramCommand command) {
  ++(is_column(command)                 ? statistics.row_hits
     : command == DramCommand::activate ? statistics.row_misses
                                        : statistics.row_conflicts);
}

/// Knows times and states, but no requests: a controller decides which command comes next. Times are those of
/// JEDEC's standards, in the form of the tables of Ramulator 2.1 (Luo et al., IEEE CAL 23(1), 2024).
class DramDevice {
 public:
  static constexpr std::int64_t no_row = -1;

  explicit DramDevice(const DramConfig& config);

  /// The command that an access to this place needs next.
  [[nodiscard]] DramCommand next_command(const DramPlace& place, bool write) const {
    const std::int64_t row = banks_[place.bank].row;
    if (row == place.row) {
      return write ? DramCommand::write : DramCommand::read;
    }
    return row == no_row ? DramCommand::activate : DramCommand::precharge;
  }
  /// The first cycle in which the command is allowed, as far as the commands issued so far tell.
  [[nodiscard]] DramCycle earliest(DramCommand command, const DramPlace& place) const;
  /// From when on the bank's row, the last one that was opened, is open for a read or write.
  [[nodiscard]] DramCycle open_from(const DramPlace& place, bool write) const {
    return of(banks_[place.bank].next, write ? DramCommand::write : DramCommand::read);
  }
  /// Issues a command that is allowed at `cycle`. Commands may be issued out of the order of their times if
  /// none of them would have moved the other. A read or write with `close` closes its row by itself.
  void issue(DramCommand command, const DramPlace& place, DramCycle cycle, bool close = false);

  /// The cycles of the commands of one burst, without any other between them; -1: no such command is needed.
  struct Course {
    DramCycle precharge = -1;
    DramCycle activate = -1;
    DramCycle column = 0;

    [[nodiscard]] DramCommand first_command(bool write) const {
      return precharge >= 0  ? DramCommand::precharge
             : activate >= 0 ? DramCommand::activate
             : write         ? DramCommand::write
                             : DramCommand::read;
    }
    [[nodiscard]] DramCycle first() const {
      return precharge >= 0 ? precharge : activate >= 0 ? activate : column;
    }
  };
  /// The course of a burst whose precharge and activation are issued from cycle `row` on, and whose read or
  /// write is issued from cycle `column` on.
  [[nodiscard]] Course course(const DramPlace& place, bool write, DramCycle row, DramCycle column) const;

  /// Issues all commands of a course.
  void issue(const Course& course, const DramPlace& place, bool write, bool close);

  [[nodiscard]] bool has_open_row(std::uint32_t rank) const;
  /// When all open rows of a rank may be closed.
  [[nodiscard]] DramCycle earliest_precharge_all(std::uint32_t rank) const;
  void precharge_all(std::uint32_t rank, DramCycle cycle);
  /// When a rank without open rows may be refreshed.
  [[nodiscard]] DramCycle earliest_refresh(std::uint32_t rank) const { return ranks_[rank].refresh; }
  void refresh(std::uint32_t rank, DramCycle cycle);
  /// Closes the rows of a rank, all of whose commands are allowed at `cycle`, and refreshes it: at once if no
  /// row was open or `closed`, else one cycle later at the earliest. Returns the cycle of the refresh.
  DramCycle refresh_idle(std::uint32_t rank, DramCycle cycle, bool closed);
  /// After so many cycles without another command each bank may be precharged, activated and refreshed.
  [[nodiscard]] DramCycle settling() const { return settling_; }

  /// The refreshes that fall due up to a cycle, if nothing delays them: one each refresh interval.
  struct DueRefreshes {
    std::int64_t more = 0;  ///< those after the first
    DramCycle last = 0;     ///< when the last one is due
  };
  /// The first one is due at `due`, which is not after `cycle`.
  [[nodiscard]] DueRefreshes due_refreshes(DramCycle due, DramCycle cycle) const {
    const std::int64_t more = (cycle - due) / timing_.refi;
    return {more, due + more * timing_.refi};
  }

  /// For which a command has its command bus.
  [[nodiscard]] DramCycle bus_cycles(DramCommand command) const {
    return is_column(command)                 ? lengths_.column
           : command == DramCommand::activate ? lengths_.activate
                                              : lengths_.precharge;
  }
  /// The cycle after the last data of a column command that is issued at `cycle`.
  [[nodiscard]] DramCycle end_of_data(DramCommand command, DramCycle cycle) const {
    return cycle + (command == DramCommand::write ? timing_.cwl : timing_.cl) + timing_.bl;
  }

 private:
  // The first cycles in which commands are allowed, by the kind of command.
  using Times = std::array<DramCycle, 4>;
  struct Bank {
    Times next{};
    DramCycle recovered = 0;  // from its last read or write: when the row may be closed, as far as these tell
    std::int64_t row = no_row;
  };
  struct Rank {
    Times next{};
    std::array<DramCycle, 4> activations{};  // the last four, oldest at `oldest`
    std::uint32_t oldest = 0;
    DramCycle precharge_all = 0;  // allowed from here on, as far as the activations tell
    DramCycle refresh = 0;        // allowed from here on, if no row is open
  };

  static void raise(DramCycle& time, DramCycle to) { time = std::max(time, to); }
  static DramCycle& of(Times& times, DramCommand command) { return times[static_cast<std::size_t>(command)]; }
  static DramCycle of(const Times& times, DramCommand command) {
    return times[static_cast<std::size_t>(command)];
  }
  void issue_activate(const DramPlace& place, DramCycle cycle);
  void issue_column(DramCommand command, const DramPlace& place, DramCycle cycle);

  DramTiming timing_;
  DramCommandSteps lengths_;
  DramCycle refresh_later_;  // than an activation of the bank would be allowed, which is counted from its end
  DramCycle settling_;
  bool one_data_bus_;
  bool one_command_bus_;
  bool refresh_after_precharge_;
  std::uint32_t banks_of_rank_;
  std::uint32_t stacks_of_rank_;
  std::vector<Bank> banks_;
  std::vector<Times> groups_;
  std::vector<DramCycle> stacks_;  // from when on each may be read, as far as reads of other stacks tell
  std::vector<Rank> ranks_;
};

inline DramCycle DramDevice::earliest(DramCommand command, const DramPlace& place) const {
  const DramCycle bank = of(banks_[place.bank].next, command);
  const Rank& rank = ranks_[place.rank];
  if (command == DramCommand::precharge) {
    return std::max(bank, of(rank.next, command));
  }
  DramCycle cycle = std::max({bank, of(groups_[place.group], command), of(rank.next, command)});
  if (command == DramCommand::activate) {
    cycle = std::max(cycle, rank.activations[rank.oldest]);
  } else if (command == DramCommand::read) {
    cycle = std::max(cycle, stacks_[place.stack]);
  }
  return cycle;
}

}  // namespace marti::memory
