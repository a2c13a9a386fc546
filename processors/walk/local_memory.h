// The time of one access to a node's own memory.
#pragma once

#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"

namespace marti::processors::walk {

class LocalMemory {
 public:
  explicit LocalMemory(const machine::LocalMemoryConfig& config)
      : width_(config.width),
        access_(config.clock.cycles(config.access_cycles)),
        beat_(config.clock.cycles(config.cycles_per_beat)) {}

  /// A read or write of `bytes` at `now`.
  [[nodiscard]] memory::Service read(std::uint32_t bytes, sim::Ticks now) const {
    const sim::Ticks transfer = sim::multiply_ticks(beat_, (std::int64_t{bytes} + width_ - 1) / width_);
    return {sim::add_ticks(now, sim::add_ticks(transfer, access_)), 0, transfer, 0, access_};
  }

 private:
  std::int64_t width_;
  sim::Ticks access_;
  sim::Ticks beat_;
};

}  // namespace marti::processors::walk
