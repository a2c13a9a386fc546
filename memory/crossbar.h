// A crossbar: a link and a queue for each bank, so only transactions of the same bank wait for each other.
#pragma once

#include "memory/banked.h"
#include "memory/link.h"

namespace marti::memory {

/// A request reaches its bank's queue `latency_cycles` after it is issued. The bank serves it, the data leave
/// over the bank's own link in the order of the requests (in that in which they are ready, where the bank
/// changes the order), and arrive `latency_cycles` after their last beat. A write is queued at the bank when
/// its address arrives; its data follow after the bank's access, over a separate path that is never the
/// bottleneck and is not counted as a link.
class Crossbar final : public Banked {
 public:
  Crossbar(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site);

  void read(const Transaction& transaction) override;
  void write(const Transaction& transaction) override;
  void reply(std::uint32_t port) override;
  [[nodiscard]] const InterconnectStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override;

 private:
  // A read whose data are ready later.
  struct Pending {
    Transaction transaction;
    sim::Ticks arrival = 0;
    BankAccess access;
  };

  void late_read(const LateAccess& read) override;
  [[nodiscard]] sim::Ticks end_of_write(const LateAccess& write) const override;
  // Sends what the bank has read over its link, in the order of the calls.
  void send_data(const Transaction& transaction, sim::Ticks arrival, const BankAccess& access);

  BeatTime beats_;
  sim::Ticks latency_;
  std::vector<Link> links_;       // read data from each bank
  std::vector<Pending> pending_;  // of each port, where reads end late
  InterconnectStatistics statistics_;
};

}  // namespace marti::memory
