// A cluster's memory system as a recorder of critical paths sees it: all that it is asked for, and when that
// is done.
#pragma once

#include <memory>

#include "memory/interconnect.h"
#include "processors/machine/machine_config.h"
#include "processors/path/memory_course.h"
#include "processors/path/path_recorder.h"

namespace marti::processors::path {

/// Stands between a cluster's nodes and their memory system and passes everything on. The recorder must
/// outlive it. Throws InternalError when a transaction is not done at the end of its recorded chain.
class WatchedMemory final : public memory::Interconnect, private memory::InterconnectClient {
 public:
  WatchedMemory(const machine::MachineConfig& config, const memory::InterconnectSite& site,
                PathRecorder& recorder);

  void read(const memory::Transaction& transaction) override;
  void write(const memory::Transaction& transaction) override;
  void count_reads(std::int64_t reads, std::int64_t bytes) override { memory_->count_reads(reads, bytes); }
  void reply(std::uint32_t port) override;
  void proceed(std::uint32_t port, std::uint32_t sequence) override;

  [[nodiscard]] const memory::InterconnectStatistics& statistics() const override {
    return memory_->statistics();
  }
  [[nodiscard]] std::vector<memory::BankStatistics> bank_statistics() const override {
    return memory_->bank_statistics();
  }
  [[nodiscard]] std::vector<memory::DramStatistics> dram_statistics(sim::Ticks end) const override {
    return memory_->dram_statistics(end);
  }
  [[nodiscard]] const memory::DistributedStatistics* distribution() const override {
    return memory_->distribution();
  }
  [[nodiscard]] const memory::NetworkStatistics* network_statistics() const override {
    return memory_->network_statistics();
  }
  [[nodiscard]] const memory::SharedCacheStatistics* cache_statistics() const override {
    return memory_->cache_statistics();
  }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override {
    return memory_->unloaded_read(bytes);
  }

 private:
  void ask(const memory::Transaction& transaction, bool write);
  void read_done(std::uint32_t port, const memory::Service& service) override;
  void write_done(std::uint32_t port, sim::Ticks done) override;

  memory::InterconnectSite site_;
  PathRecorder& recorder_;
  std::unique_ptr<memory::Interconnect> memory_;
  std::unique_ptr<MemoryCourse> course_;
};

}  // namespace marti::processors::path
