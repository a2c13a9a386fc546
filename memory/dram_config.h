// A memory of DRAM channels, as values: its timing, its geometry and how its controller works.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/time.h"

namespace marti::memory {

/// In which order a channel's controller serves its requests. fcfs: reads and writes in the order in which
/// they arrive. frfcfs: of the requests in its queue, the oldest one whose next command is allowed.
enum class DramPolicy : std::uint8_t { fcfs, frfcfs };
inline constexpr std::array<std::string_view, 2> dram_policy_names = {"fcfs", "frfcfs"};

/// What happens to a row after an access. open: it stays open until another row of its bank is wanted.
/// closed: the access closes it (auto-precharge).
enum class DramPage : std::uint8_t { open, closed };
inline constexpr std::array<std::string_view, 2> dram_page_names = {"open", "closed"};

/// Least times between commands, in cycles of the DRAM's clock; names as in the JEDEC standards. `l` is for
/// commands to the same bank group, `s` for commands to different ones.
struct DramTiming {
  std::int64_t bl = 4;           ///< data of one burst on the data bus
  std::int64_t cl = 16;          ///< read command to its first data
  std::int64_t cwl = 12;         ///< write command to its first data
  std::int64_t rcd = 16;         ///< activation to a read of the row
  std::int64_t rcd_write = 16;   ///< activation to a write of the row
  std::int64_t rp = 16;          ///< precharge to activation
  std::int64_t ras = 39;         ///< activation to precharge
  std::int64_t rc = 55;          ///< activation to activation of the same bank
  std::int64_t rrd_s = 4;        ///< activation to activation of another bank
  std::int64_t rrd_l = 6;        ///< of the same bank group
  std::int64_t faw = 26;         ///< in which a rank may have four activations
  std::int64_t ccd_s = 4;        ///< read to read, write to write
  std::int64_t ccd_l = 6;        ///< read to read of the same bank group
  std::int64_t ccd_l_write = 6;  ///< write to write of the same bank group
  std::int64_t ccd_stack = 4;    ///< read to read of another stack of the rank
  std::int64_t wr = 18;          ///< end of written data to precharge
  std::int64_t wtr_s = 3;        ///< end of written data to a read
  std::int64_t wtr_l = 9;        ///< of the same bank group
  std::int64_t rtp = 9;          ///< read to precharge
  std::int64_t ppd = 1;          ///< precharge to precharge of the same rank
  std::int64_t rtw_gap = 2;      ///< free cycles of the data bus between data read and data written
  std::int64_t rank_gap = 2;     ///< free cycles of the data bus between data of two ranks
  std::int64_t refi = 9364;      ///< between two refreshes; 0: no refresh
  std::int64_t rfc = 433;        ///< one refresh
};

/// The parts of an address that choose a place in the memory.
enum class DramField : std::uint8_t { channel, rank, stack, bank_group, bank, row, column };
inline constexpr std::array<std::string_view, 7> dram_field_names = {"channel", "rank", "stack", "bank_group",
                                                                     "bank",    "row",  "column"};

/// A run of address bits; `bits` 0: all bits of the field that no other run has.
struct DramFieldBits {
  DramField field = DramField::column;
  std::uint32_t bits = 0;
};

/// How long commands have their bus.
struct DramCommandSteps {
  std::int64_t activate = 1;
  std::int64_t precharge = 1;  ///< or a refresh
  std::int64_t column = 1;
};

/// All counts are powers of two. A column is one burst.
struct DramConfig {
  std::size_t preset = 0;  ///< index in dram_preset_names of the memory it was made of, whose energy it takes
  sim::Ticks period = 833;  ///< of the DRAM's clock
  DramTiming timing;
  std::uint32_t channels = 1;
  std::uint32_t ranks = 1;   ///< of a channel
  std::uint32_t stacks = 1;  ///< of a rank: groups of dies that share its data bus, as the stack IDs of HBM3
  std::uint32_t bank_groups = 4;  ///< of a stack
  std::uint32_t banks = 4;        ///< of a bank group
  std::uint32_t rows = 65536;     ///< of a bank
  std::uint32_t row_bytes = 8192;
  std::uint32_t burst_bytes = 64;
  /// Whether commands that open and close rows have a command bus of their own, as in HBM.
  bool two_command_buses = false;
  /// Whether each rank has a data bus of its own, as the pseudo channels of HBM, which share command buses.
  bool pseudo_channels = false;
  /// Whether a refresh waits for the end of a precharge of a single bank, as it does for one of all banks.
  bool refresh_after_precharge = true;
  std::int64_t activate_cycles = 1;  ///< that an activation has the command bus
  std::int64_t column_cycles = 1;    ///< that a read or write has it
  /// Whether commands take half cycles as in HBM3: an activation has its bus for three halves, a precharge
  /// and a refresh for one, and a precharge may also begin in the middle of a cycle. Only frfcfs does so:
  /// fcfs rounds up to whole cycles.
  bool half_cycles = false;
  /// As in LPDDR5, and by frfcfs only: an activation is two commands, between which no other activation
  /// comes; the second is issued when no other command can be, at most so many cycles after the first. 0: it
  /// is one command.
  std::int64_t second_activation = 0;
  /// As in LPDDR5, and by frfcfs only: so many cycles after the last data the data clock stops, and the next
  /// read or write has a command to start it in the cycle before. 0: it always runs.
  std::int64_t data_clock_tail = 0;
  DramPolicy policy = DramPolicy::fcfs;
  DramPage page = DramPage::open;
  std::uint32_t queue = 32;        ///< frfcfs: bursts read, and as many written, that a channel chooses from
  std::uint32_t reorder_cap = 16;  ///< frfcfs: younger bursts that may go before one; 0: any number
  /// From the least significant bit above a burst upwards. Stacks come directly after the rank where there
  /// are several and they are not named.
  std::vector<DramFieldBits> mapping = {{DramField::column, 0}, {DramField::channel, 0},
                                        {DramField::rank, 0},   {DramField::bank_group, 0},
                                        {DramField::bank, 0},   {DramField::row, 0}};

  /// Steps of a cycle in which the controller can issue commands.
  [[nodiscard]] std::int64_t steps() const { return half_cycles && policy == DramPolicy::frfcfs ? 2 : 1; }
  /// How long a command has its bus, in steps.
  [[nodiscard]] DramCommandSteps command_steps() const;
  /// The times from the first step of one command to the first step of the next, in steps. The standards
  /// count them from the end of the first to the end of the second, where these take several.
  [[nodiscard]] DramTiming timing_of_commands() const;
  /// From one activation of a bank to the next one whose row closed by itself in between, in cycles.
  /// Standards give times in ns, of which tRC is tRAS and tRP together: where it is one cycle less than their
  /// sum, each has been rounded up by itself, and it is the exact one.
  [[nodiscard]] std::int64_t row_cycle() const {
    const std::int64_t sum = timing.ras + timing.rp;
    return sum == timing.rc + 1 ? timing.rc : std::max(timing.rc, sum);
  }
  /// For which a burst has the data bus of a channel; of pseudo channels a part of all their buses.
  [[nodiscard]] sim::Ticks burst_time() const { return period * timing.bl / (pseudo_channels ? ranks : 1); }
  [[nodiscard]] std::uint32_t columns() const { return row_bytes / burst_bytes; }
  /// Bytes that all channels hold.
  [[nodiscard]] std::uint64_t capacity() const {
    return std::uint64_t{channels} * ranks * banks_of_rank() * rows * row_bytes;
  }
  [[nodiscard]] std::uint32_t banks_of_rank() const { return stacks * bank_groups * banks; }
  /// Bytes a second over all channels, if data are moved without a pause.
  [[nodiscard]] double peak_bandwidth() const;
};

/// Throws KeyError with the reason when there can be no such memory. `line` is the most that one access
/// reads or writes; it must lie in one channel.
void check(const DramConfig& config, std::uint32_t line);

}  // namespace marti::memory
