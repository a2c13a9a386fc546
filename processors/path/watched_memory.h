// A cluster's memory system as a recorder of critical paths sees it: all that it is asked for, and when that
// is done.
#pragma once

#include <memory>

#include "memory/interconnect.h"
#include "memory/passed_on.h"
#include "processors/machine/machine_config.h"
#include "processors/path/memory_course.h"
#include "processors/path/path_recorder.h"

namespace marti::processors::path {

/// Stands between a cluster's nodes and their memory system and passes everything on. The recorder must
/// outlive it. Throws InternalError when a transaction is not done at the end of its recorded chain.
class WatchedMemory final : public memory::PassedOn, private memory::InterconnectClient {
 public:
  WatchedMemory(const machine::MachineConfig& config, const memory::InterconnectSite& site,
                PathRecorder& recorder);

  void read(const memory::Transaction& transaction) override;
  void write(const memory::Transaction& transaction) override;
  void reply(std::uint32_t port) override;
  void proceed(std::uint32_t port, std::uint32_t sequence) override;

 private:
  void ask(const memory::Transaction& transaction, bool write);
  void read_done(std::uint32_t port, const memory::Service& service) override;
  void write_done(std::uint32_t port, sim::Ticks done) override;

  memory::InterconnectSite site_;
  PathRecorder& recorder_;
  std::unique_ptr<MemoryCourse> course_;
};

}  // namespace marti::processors::path
