// One bus for a cluster, granted by round robin or by fixed priority.
#pragma once

#include <vector>

#include "memory/banked.h"
#include "memory/link.h"
#include "memory/port_set.h"

namespace marti::memory {

/// Transfers are those of Bus. Ports that want the bus wait; when it is free, one event of the site's memory
/// class grants it, so that all ports that ask at that instant compete. A port offers one transfer at a time:
/// data that are ready for it, else the oldest of its requests. Reads and writes keep the order in which they
/// were made, so that no read of a port overtakes its writes.
class ArbitratedBus final : public Banked {
 public:
  ArbitratedBus(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site);

  void read(const Transaction& transaction) override;
  void write(const Transaction& transaction) override;
  void reply(std::uint32_t port) override;
  void proceed(std::uint32_t port, std::uint32_t sequence) override;
  [[nodiscard]] const InterconnectStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override;
  /// The port that the bus was granted to last; at first the highest.
  [[nodiscard]] std::uint32_t last_granted() const { return last_; }

 private:
  struct Request {
    Transaction transaction;
    sim::Ticks asked = 0;
    bool write = false;
  };
  struct Port {
    std::vector<Request> requests;  // oldest first; few: the content of the write buffer and one read
    Service service;                // of the split read whose data are under way
    std::uint32_t bytes = 0;
    sim::Ticks ready = 0;  // when the data began to wait
  };

  void ask(const Transaction& transaction, bool write);
  // Posts the event that grants the bus, unless it is already posted.
  void call_for_grant();
  // The port that gets the bus next; one of the sets must not be empty.
  [[nodiscard]] std::uint32_t choose() const;
  // Begins a tenure of `length` for a transfer that was asked for at `asked`.
  void take(sim::Ticks asked, sim::Ticks length);
  void late_read(const LateAccess& read) override;
  // Grants the bus to the port that gets it next.
  void grant();
  void grant_data(std::uint32_t port);
  void grant_read(const Request& request);
  void grant_write(const Request& request);

  BusMode mode_;
  Arbitration arbitration_;
  BeatTime beats_;
  sim::Ticks address_;
  std::vector<Port> ports_;
  PortSet data_;        // ports whose data are ready
  PortSet asking_;      // ports with data or requests
  std::uint32_t last_;  // the port that had the bus last
  sim::Ticks free_at_ = 0;
  bool called_ = false;
  InterconnectStatistics statistics_;
};

}  // namespace marti::memory
