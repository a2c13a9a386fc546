// One bus for a cluster: one transfer at a time, first come first served.
#pragma once

#include "memory/interconnect.h"
#include "memory/link.h"

namespace marti::memory {

/// A read sends its address, waits for its bank, and receives its data; a write sends address and data in one
/// tenure and does not wait for the bank. In `held` mode a read keeps the bus from its address to its data;
/// in `split` mode it gives the bus back, and the data ask for the bus again when they are ready.
class Bus final : public Interconnect {
 public:
  Bus(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site);

  void read(const Transaction& transaction) override;
  void write(const Transaction& transaction) override;
  void reply(std::uint32_t port) override;
  [[nodiscard]] const InterconnectStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] const std::vector<BankStatistics>& bank_statistics() const override {
    return banks_.statistics();
  }
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const override {
    return banks_.cache_statistics();
  }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override;

 private:
  // A split read between its address and its data.
  struct Pending {
    Service service;
    std::uint32_t bytes = 0;
  };

  // Grants the bus to a tenure of `length` that arrives at `arrival`; returns when it starts.
  sim::Ticks take(sim::Ticks arrival, sim::Ticks length);
  // Sends the data of the port's read, which are ready at `ready`.
  void send_data(std::uint32_t port, sim::Ticks ready);

  InterconnectSite site_;
  BusMode mode_;
  BeatTime beats_;
  sim::Ticks address_;
  sim::Ticks bank_access_;
  Banks banks_;
  Link link_;
  std::vector<Pending> pending_;
  InterconnectStatistics statistics_;
};

}  // namespace marti::memory
