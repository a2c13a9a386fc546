// An interconnect that stands before another one and passes everything on: for those who listen.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "memory/interconnect.h"

namespace marti::memory {

class PassedOn : public Interconnect {
 public:
  void read(const Transaction& transaction) override { next_->read(transaction); }
  void write(const Transaction& transaction) override { next_->write(transaction); }
  void count_reads(std::int64_t reads, std::int64_t bytes) override { next_->count_reads(reads, bytes); }
  void reply(std::uint32_t port) override { next_->reply(port); }
  void proceed(std::uint32_t port, std::uint32_t sequence) override { next_->proceed(port, sequence); }
  void prepare(std::uint32_t port) const override { next_->prepare(port); }
  [[nodiscard]] bool prepare_more(std::uint32_t port) const override { return next_->prepare_more(port); }

  [[nodiscard]] const InterconnectStatistics& statistics() const override { return next_->statistics(); }
  [[nodiscard]] std::vector<BankStatistics> bank_statistics() const override {
    return next_->bank_statistics();
  }
  [[nodiscard]] std::vector<DramStatistics> dram_statistics(sim::Ticks end) const override {
    return next_->dram_statistics(end);
  }
  [[nodiscard]] const DistributedStatistics* distribution() const override { return next_->distribution(); }
  [[nodiscard]] const NetworkStatistics* network_statistics() const override {
    return next_->network_statistics();
  }
  [[nodiscard]] const SharedCacheStatistics* cache_statistics() const override {
    return next_->cache_statistics();
  }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override {
    return next_->unloaded_read(bytes);
  }

 protected:
  explicit PassedOn(std::unique_ptr<Interconnect> next) : next_(std::move(next)) {}
  [[nodiscard]] Interconnect& next() const { return *next_; }

 private:
  std::unique_ptr<Interconnect> next_;
};

}  // namespace marti::memory
