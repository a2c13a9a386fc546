// DRAM channels whose controllers choose among the accesses in their queues, so that the end of an access is
// known only when its last command is issued.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "memory/dram.h"
#include "memory/dram_queued.h"
#include "memory/interconnect.h"

namespace marti::memory {

/// The writes of ports that end in another order than they were made in.
class WriteOrder {
 public:
  explicit WriteOrder(std::uint32_t ports) : ports_(ports) {}

  /// A write of the port is made.
  void made(std::uint32_t port, Address address) { ports_[port].push_back({address, not_done}); }
  /// Its write to this address, the oldest one that is not done, is done at `done`; reports all writes that
  /// are done and have no older one that is not.
  void finish(std::uint32_t port, Address address, sim::Ticks done, InterconnectClient& client);

 private:
  static constexpr sim::Ticks not_done = -1;
  struct Write {
    Address address = 0;
    sim::Ticks done = not_done;
  };
  std::vector<std::vector<Write>> ports_;  // oldest first; few: what a write buffer holds
};

/// An access that has got its last command.
struct LateAccess {
  Transaction transaction;
  bool write = false;
  sim::Ticks arrival = 0;
  sim::Ticks start = 0;  ///< when the controller takes it up, a cycle before its first command
  sim::Ticks ready = 0;  ///< when all its data have moved
};

/// A command is decided when every access is known that arrives before it. Where that is not yet so, an event
/// of the site's memory class, with the sequence number 1 + channel, is posted for the time at which it is.
class LateDram {
 public:
  /// `notice`: every access is announced so long before it arrives, or longer.
  LateDram(const DramConfig& config, const InterconnectSite& site, sim::Ticks notice);

  /// Announces an access; arrivals must not decrease. `known`: every access announced later arrives at this
  /// time or after it. Calls done(LateAccess) for each access that got its last command.
  template <class Done>
  void ask(const Transaction& transaction, bool write, sim::Ticks arrival, sim::Ticks known,
           const Done& done) {
    const std::uint32_t channel = announce(transaction, write, arrival);
    if (clock_.ticks(clock_.cycle_at(arrival)) < known) {
      proceed(channel, known, done);
    } else {
      post(channel, clock_.cycle_at(arrival) + 1);
    }
  }
  /// ask() for a read of the only port: nothing else arrives before its end, so all commands up to its last
  /// are decided at once.
  template <class Done>
  void ask_alone(const Transaction& transaction, sim::Ticks arrival, const Done& done) {
    const std::uint32_t channel = announce(transaction, false, arrival);
    for (bool read = false; !read;) {
      const LateAccess ended = finished(channel, *advance(channel, std::numeric_limits<sim::Ticks>::max()));
      read = !ended.write;
      done(ended);
    }
    wake(channel);
  }
  /// Handles the event of a channel; calls done(LateAccess) for each access that got its last command.
  template <class Done>
  void handle(std::uint32_t channel, const Done& done) {
    begin_event(channel);
    proceed(channel, sim::add_ticks(site_.engine.now(), notice_), done);
  }

  [[nodiscard]] std::vector<DramStatistics> statistics(sim::Ticks end) const;
  [[nodiscard]] WriteOrder& writes() { return writes_; }
  /// Of each channel, as those of banks.
  [[nodiscard]] const std::vector<BankStatistics>& bank_statistics() const { return banks_; }

 private:
  struct Asked {
    Transaction transaction;
    bool write = false;
    sim::Ticks arrival = 0;
  };
  struct Channel {
    explicit Channel(const DramConfig& config) : dram(config) {}
    DramQueued dram;
    std::deque<std::uint64_t> coming;  // announced, in order of arrival: places in asked_
    std::vector<sim::Ticks> events;    // times of its events; few
  };

  template <class Done>
  void proceed(std::uint32_t channel, sim::Ticks known, const Done& done) {
    while (const std::optional<DramDone> ended = advance(channel, known)) {
      done(finished(channel, *ended));
    }
    wake(channel);
  }
  void begin_event(std::uint32_t channel);
  // Notes an access that will arrive; returns its channel.
  std::uint32_t announce(const Transaction& transaction, bool write, sim::Ticks arrival);
  // Lets accesses arrive and issues commands, up to the end of an access. `known`: every access announced
  // later arrives at this time or after it.
  std::optional<DramDone> advance(std::uint32_t channel, sim::Ticks known);
  LateAccess finished(std::uint32_t channel, const DramDone& done);
  // Posts the event of the channel's next command, if there is one and no earlier event.
  void wake(std::uint32_t channel);
  void post(std::uint32_t channel, DramCycle command);
  // The first time at which everything that arrives before this command's cycle is known.
  [[nodiscard]] sim::Ticks decided_at(DramCycle command) const {
    return clock_.ticks(command - 1) - notice_ + 1;
  }

  InterconnectSite site_;
  DramClock clock_;
  sim::Ticks notice_;
  DramMapping mapping_;
  std::uint32_t burst_bytes_;
  sim::Ticks burst_ticks_;
  std::vector<Channel> channels_;
  std::vector<BankStatistics> banks_;
  WriteOrder writes_;
  std::vector<Asked> asked_;
  std::vector<std::uint64_t> unused_;  // places in asked_
};

}  // namespace marti::memory
