// What interconnects with banks behind them share.
#pragma once

#include <memory>

#include "memory/interconnect.h"
#include "memory/late_dram.h"

namespace marti::memory {

/// Banks, or DRAM channels in their place. Where the end of an access is known when it arrives, banks() tells
/// it at once. Else late() is true: an access is asked for, and its end is told later.
class Banked : public Interconnect {
 public:
  void proceed(std::uint32_t port, std::uint32_t sequence) override;
  [[nodiscard]] const std::vector<BankStatistics>& bank_statistics() const override {
    return late_ ? late_->bank_statistics() : banks_.statistics();
  }
  [[nodiscard]] std::vector<DramStatistics> dram_statistics() const override {
    return late_ ? late_->statistics() : banks_.dram_statistics();
  }
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const override {
    return banks_.cache_statistics();
  }

 protected:
  /// `notice`: every access is asked for so long before it arrives, or longer.
  Banked(const BankConfig& banks, const InterconnectSite& site, sim::Ticks notice)
      : site_(site),
        banks_(banks),
        late_(banks.dram && banks.dram->policy == DramPolicy::frfcfs
                  ? std::make_unique<LateDram>(*banks.dram, site, notice)
                  : nullptr),
        writes_(late_ ? site.ports : 0) {}

  [[nodiscard]] bool late() const { return late_ != nullptr; }
  /// Where accesses end late: an access that arrives at `arrival`. A write is reported to the client when its
  /// data have been written.
  void ask_late(const Transaction& transaction, bool write, sim::Ticks arrival);
  /// A read's data will be ready at read.ready, which is not in the past.
  virtual void late_read(const LateAccess& read) = 0;
  /// When a write is done, given when its bank has served it.
  [[nodiscard]] virtual sim::Ticks end_of_write(const LateAccess& write) const { return write.ready; }

  InterconnectSite site_;
  Banks banks_;

 private:
  std::unique_ptr<LateDram> late_;
  WriteOrder writes_;
};

}  // namespace marti::memory
