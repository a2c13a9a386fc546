// What interconnects with banks behind them share.
#pragma once

#include <memory>

#include "memory/interconnect.h"

namespace marti::memory {

class LateDram;
struct LateAccess;

/// Banks, or DRAM channels in their place. Where the end of an access is known when it arrives, banks() tells
/// it at once. Else late() is true: an access is asked for, and its end is told as soon as no later arrival
/// can change it, which may be at once.
class Banked : public Interconnect {
 public:
  void proceed(std::uint32_t port, std::uint32_t sequence) override;
  [[nodiscard]] std::vector<BankStatistics> bank_statistics() const override;
  [[nodiscard]] std::vector<DramStatistics> dram_statistics(sim::Ticks end) const override;
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const override {
    return banks_.cache_statistics();
  }
  Banked(const Banked&) = delete;
  Banked& operator=(const Banked&) = delete;
  Banked(Banked&&) = delete;
  Banked& operator=(Banked&&) = delete;
  ~Banked() override;

 protected:
  /// `notice`: every access is asked for so long before it arrives, or longer. `one_at_a_time`: between two
  /// arrivals there is at least that time, as on a bus that sends one address after the other.
  Banked(const BankConfig& banks, const InterconnectSite& site, sim::Ticks notice, bool one_at_a_time);

  [[nodiscard]] bool late() const { return late_ != nullptr; }
  /// Where accesses end late: an access that arrives at `arrival`, in order of arrival. A write is reported
  /// to the client when its data have been written.
  void ask_late(const Transaction& transaction, bool write, sim::Ticks arrival);
  /// A read's data will be ready at read.ready, which is not in the past. Uses only the port of the
  /// transaction: of a read that waited for another port's line the rest is not set.
  virtual void late_read(const LateAccess& read) = 0;
  /// Posts the event of the site's reply class for a port's read whose data are ready at `ready`.
  [[gnu::always_inline]] void post_reply(std::uint32_t port, sim::Ticks ready) {
    site_.engine.post_in_order(sim::Event::make(ready, site_.reply_class, site_.first_component + port));
  }
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
  // The least time from one arrival to the next.
  sim::Ticks distance_;
};

}  // namespace marti::memory
