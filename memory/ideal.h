// The ideal interconnect: every transaction takes the same time and none waits for another.
#pragma once

#include "memory/interconnect.h"

namespace marti::memory {

/// Reads and writes are done `latency_cycles` after they are issued, whatever their size. No banks.
class Ideal final : public Interconnect {
 public:
  Ideal(const InterconnectConfig& config, const InterconnectSite& site)
      : site_(site), latency_(ideal_read(config)) {
    statistics_.links = site.ports;
  }

  void read(const Transaction& transaction) override {
    ++statistics_.reads;
    count(transaction);
    const sim::Ticks done = sim::add_ticks(site_.engine.now(), latency_);
    site_.client.read_done(transaction.port, {done, 0, latency_, 0, 0});
  }
  void count_reads(std::int64_t reads, std::int64_t bytes) override {
    statistics_.reads += reads;
    statistics_.bytes += bytes;
    statistics_.busy += sim::Sum{latency_} * reads;
    statistics_.held += sim::Sum{latency_} * reads;
    statistics_.waits.add_unwaited(reads);
  }
  void write(const Transaction& transaction) override {
    ++statistics_.writes;
    count(transaction);
    site_.client.write_done(transaction.port, sim::add_ticks(site_.engine.now(), latency_));
  }
  [[nodiscard]] const InterconnectStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] std::vector<BankStatistics> bank_statistics() const override { return {}; }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t /*bytes*/) const override { return latency_; }

 private:
  void count(const Transaction& transaction) {
    statistics_.bytes += transaction.bytes;
    statistics_.busy += latency_;
    statistics_.held += latency_;
    statistics_.waits.add(0);
  }

  InterconnectSite site_;
  sim::Ticks latency_;
  InterconnectStatistics statistics_;
};

}  // namespace marti::memory
