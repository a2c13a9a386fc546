// A DRAM channel that chooses among the accesses in its queue: first ready, first come, first served.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <unordered_set>
#include <vector>

#include "memory/dram_buses.h"
#include "memory/dram_device.h"
#include "memory/dram_in_order.h"
#include "memory/dram_statistics.h"

namespace marti::memory {

/// An access whose last burst has got its command.
struct DramDone {
  std::uint64_t tag = 0;  ///< given by the one who asked
  DramService service;
};

/// The controller of Ramulator 2.1 with its scheduler FRFCFS (Luo et al., IEEE CAL 23(1), 2024; Rixner et
/// al., Memory access scheduling, ISCA 2000). Reads and writes wait in a queue each; what finds its queue
/// full waits before it, in order of arrival. Of the bursts in a queue, the oldest one whose next command is
/// allowed gets it. A burst that has opened its row leaves the queue and goes before all others until it has
/// moved its data; its row is not closed before. With a cap, a burst that so many younger ones of its queue
/// have overtaken goes before all younger ones. Writes are served when no read waits, or from the moment at
/// which four fifths of their queue are full until less than one fifth is. A read whose bursts all
/// wait to be written gets their data a cycle after its arrival. When a refresh is due, bursts whose rows
/// they have opened end first, then all rows are closed and each rank is refreshed.
///
/// The caller advances it command by command: step() while next() is not later than the next arrival.
class DramQueued {
 public:
  static constexpr DramCycle never = std::numeric_limits<DramCycle>::max();

  explicit DramQueued(const DramConfig& config);

  /// An access that arrives at request.arrival, not before any command issued so far. `known`, in ticks: no
  /// further access arrives earlier. Returns the access if no further one can change when it is done: a read
  /// whose data wait to be written, or an access that meets no other.
  std::optional<DramDone> enter(const DramRequest& request, Address address, std::uint64_t tag,
                                sim::Ticks known);
  /// The cycle of the next command, if nothing arrives before; never without an access that waits.
  [[nodiscard]] DramCycle next();
  /// Issues the command of that cycle. Returns the access that is done by it, if there is one.
  std::optional<DramDone> step();

  [[nodiscard]] bool idle() const {
    return reads_.empty() && writes_.empty() && active_.empty() && before_.empty() && !activating_;
  }
  /// What was counted, for a frame that ends at `end`.
  [[nodiscard]] DramStatistics statistics(sim::Ticks end) const {
    DramStatistics all = statistics_;
    buses_.count(all, end);
    return all;
  }

 private:
  struct Burst {
    DramPlace place;
    Address address = 0;
    std::uint64_t order = 0;
    std::uint32_t access = 0;  // place in accesses_
    std::int64_t passed = 0;   // younger bursts that have left the queue before it
    bool write = false;
    Address line = 0;    // the first byte of its access
    bool alone = false;  // the only burst of its access
    bool begun = false;  // has had a command
  };
  struct Access {
    std::uint64_t tag = 0;
    DramCycle arrival = 0;
    DramService service;
    std::int64_t left = 0;  // bursts
  };
  enum class Kind : std::uint8_t { active, queue, precharge_all, refresh, second_activation };
  struct Pick {
    DramCycle cycle = never;
    Kind kind = Kind::queue;
    DramCommand command = DramCommand::read;
    std::size_t index = 0;  // of the burst
  };

  // The first step from `step` on that begins a cycle.
  [[nodiscard]] DramCycle whole(DramCycle step) const { return steps_ == 1 ? step : step + (step & 1); }
  [[nodiscard]] DramCycle slot(DramCommand command) const {
    return is_column(command) ? next_column_ : next_row_;
  }
  // Whether a command comes before another one: with two command buses, a cycle's read or write goes first.
  [[nodiscard]] bool goes_first(const Pick& pick, const Pick& other) const {
    return pick.cycle < other.cycle || (two_command_buses_ && pick.cycle == other.cycle &&
                                        is_column(pick.command) && !is_column(other.command));
  }
  // Finds the burst whose command can come first, from cycle `from` on, if that is before `best`.
  void pick_among(const std::vector<Burst>& bursts, Kind kind, DramCycle from, Pick& best) const;
  void pick_refresh(Pick& best) const;
  [[nodiscard]] Pick pick() const;
  // The next command beside that of an activation that has had its first.
  [[nodiscard]] Pick pick_other() const;
  // Whether a burst of this bank has opened its row and not yet moved its data.
  [[nodiscard]] bool in_use(std::uint32_t bank) const;
  void make_active(const Burst& burst);
  // Issues all commands of an access of one burst to an idle channel, if the last one comes before the next
  // refresh and is known to meet no other access.
  std::optional<DramDone> serve_alone(const DramRequest& request, std::uint64_t tag, sim::Ticks known);
  // Whether all bytes of a read are those of writes that wait.
  [[nodiscard]] bool waits_to_be_written(const DramRequest& request, Address address) const;
  // Makes `cycle` the present. Whether writes are served was decided anew in each cycle up to it in which the
  // queues were asked for a command: while no refresh was due, and in `cycle` itself if `asked`.
  void settle(DramCycle cycle, bool asked);
  // Whether writes are to be served, given what waits.
  [[nodiscard]] bool write_mode() const;
  std::optional<DramDone> issue(std::vector<Burst>& from, const Pick& pick);
  // With closed pages: whether a burst's read or write closes its row. It does if no other burst of the same
  // line waits in the controller, be it of the same access or of another one; a burst that is a line always
  // does.
  [[nodiscard]] bool closes_row(const Burst& burst) const;
  // Counts the first command of a burst of an access that arrived at `arrival`.
  void count_start(DramCycle arrival, DramCommand command, DramCycle cycle);
  // Counts how long an access waited for its last command.
  void count_queued(DramCycle arrival, DramCycle last);
  // The earliest arrival of the accesses that wait to move data on the bus of a rank; `arrival` at the
  // latest.
  [[nodiscard]] DramCycle asked_for_bus(std::uint32_t rank, DramCycle arrival) const;
  void use_slot(DramCommand command, DramCycle cycle);
  void issue_refresh(const Pick& pick);
  // Moves what waits before the queues into them.
  void fill();
  // Issues the refreshes that were due up to `cycle` while nothing waited.
  void catch_up(DramCycle cycle);

  DramCycle steps_;  // of a cycle
  DramCycle refi_;
  DramCycle rfc_;
  sim::Ticks period_;
  sim::Ticks burst_time_;
  std::uint32_t ranks_;
  std::uint32_t burst_bytes_;
  std::size_t queue_;
  std::int64_t cap_;
  bool two_command_buses_;
  bool close_;
  DramCycle second_within_;
  DramCycle clock_tail_;
  DramDevice device_;
  DramBuses buses_;
  DramStatistics statistics_;
  std::vector<Burst> reads_;
  std::vector<Burst> writes_;
  std::vector<Burst> active_;
  std::optional<Burst> activating_;  // has had the first command of its activation
  DramCycle second_by_ = 0;          // the last cycle for the second one
  DramCycle clock_stops_ = 0;        // from when on the data clock has to be started
  DramCycle clock_started_ = -1;     // cycle of the last read or write that followed its start
  std::deque<Burst> before_;
  std::unordered_multiset<Address> unwritten_;  // of bursts that wait to be written
  std::vector<Access> accesses_;
  std::vector<std::uint32_t> unused_;  // places in accesses_
  std::optional<Pick> next_;           // the next command, if it is known
  DramCycle now_ = -1;                 // cycle of the last command or arrival
  DramCycle next_column_ = 0;          // first cycles in which the command buses are free
  DramCycle next_row_ = 0;
  std::uint64_t entered_ = 0;
  bool writing_ = false;
  DramCycle refresh_due_;
  DramCycle last_refresh_ = 0;
  std::uint32_t refresh_rank_ = 0;  // the rank that is refreshed next
  DramCycle stall_begin_ = never;   // of a refresh that no access has begun after
  DramCycle stall_end_ = 0;
};

}  // namespace marti::memory
