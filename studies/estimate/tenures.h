// How long reads and writes hold a machine's interconnect, without contention.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/time.h"

namespace marti::studies::estimate {

/// Times of one read of a line, or of one write of a pixel, over the interconnect, in ticks.
struct Tenures {
  bool bus = false;       ///< false: the interconnect is ideal
  double read = 0.0;      ///< for which a read holds the bus
  double write = 0.0;     ///< for which a write holds the bus
  double per_read = 1.0;  ///< how often a read requests the bus
  double miss = 0.0;      ///< of a read without contention
  double bank_busy = 0.0;
  sim::Ticks last_write = 0;  ///< from the start of a write to its end
};

/// A crossbar is taken as one of its links.
[[nodiscard]] Tenures tenures_of(const processors::machine::MachineConfig& machine);

}  // namespace marti::studies::estimate
