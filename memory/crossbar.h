// A crossbar: a link and a queue for each bank, so only transactions of the same bank wait for each other.
#pragma once

#include "memory/interconnect.h"
#include "memory/link.h"

namespace marti::memory {

/// A request reaches its bank's queue `latency_cycles` after it is issued. The bank serves it, the data leave
/// over the bank's own link in the order of the requests, and arrive `latency_cycles` after their last beat.
/// A write is queued at the bank when its address arrives; its data follow after the bank's access, over a
/// separate path that is never the bottleneck and is not counted as a link.
class Crossbar final : public Interconnect {
 public:
  Crossbar(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site);

  void read(const Transaction& transaction) override;
  void write(const Transaction& transaction) override;
  [[nodiscard]] const InterconnectStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] const std::vector<BankStatistics>& bank_statistics() const override {
    return banks_.statistics();
  }
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const override {
    return banks_.cache_statistics();
  }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override;

 private:
  InterconnectSite site_;
  BeatTime beats_;
  sim::Ticks latency_;
  sim::Ticks bank_access_;
  Banks banks_;
  std::vector<Link> links_;  // read data from each bank
  InterconnectStatistics statistics_;
};

}  // namespace marti::memory
