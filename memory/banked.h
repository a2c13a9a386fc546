// What interconnects with banks behind them share.
#pragma once

#include <memory>

#include "memory/interconnect.h"

namespace marti::memory {

class LateDram;
struct LateAccess;

/// Banks, or DRAM channels in their place. Where the end of an access is known when it arrives, banks() tells
/// it at once. Else late() is true: an access is asked for, and its end is told later.
class Banked : public Interconnect {
 public:
  void proceed(std::uint32_t port, std::uint32_t sequence) override;
  [[nodiscard]] const std::vector<BankStatistics>& bank_statistics() const override;
  [[nodiscard]] std::vector<DramStatistics> dram_statistics() const override;
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const override {
    return banks_.cache_statistics();
  }
  Banked(const Banked&) = delete;
  Banked& operator=(const Banked&) = delete;
  Banked(Banked&&) = delete;
  Banked& operator=(Banked&&) = delete;
  ~Banked() override;

 protected:
  /// `notice`: every access is asked for so long before it arrives, or longer. `one_at_a_time`: accesses
  /// arrive at distances of at least `notice`.
  Banked(const BankConfig& banks, const InterconnectSite& site, sim::Ticks notice, bool one_at_a_time);

  [[nodiscard]] bool late() const { return late_ != nullptr; }
  /// Where accesses end late: an access that arrives at `arrival`, in order of arrival. A write is reported
  /// to the client when its data have been written.
  void ask_late(const Transaction& transaction, bool write, sim::Ticks arrival);
  /// A read's data will be ready at read.ready, which is not in the past. Of the transaction only the port is
  /// given.
  virtual void late_read(const LateAccess& read) = 0;
  /// When a write is done, given when its bank has served it.
  [[nodiscard]] virtual sim::Ticks end_of_write(const LateAccess& write) const;

  InterconnectSite site_;
  Banks banks_;

 private:
  // Whether the cache before the banks serves a read, now or later.
  bool cached(const Transaction& transaction, sim::Ticks arrival);
  // Reports the end of a write to the client, and of a read to the interconnect, with those that waited for
  // it.
  void finish(const LateAccess& access);

  std::unique_ptr<LateDram> late_;
  // How long after an arrival the next access may arrive.
  sim::Ticks distance_;
};

}  // namespace marti::memory
