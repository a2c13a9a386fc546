// The machines that the stability study times, and a frame small enough to be timed thousands of times.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "studies/stability/stability_case.h"

namespace marti::studies::stability {

/// A frame of 24 x 16 pixels with shadows and reflections, rendered once.
[[nodiscard]] const processors::program::WorkLog& small_log();

struct NamedTiming {
  std::string name;
  processors::machine::MachineConfig machine;

  /// The name as the end of a case's id.
  [[nodiscard]] std::string id() const {
    std::string text = name;
    std::ranges::replace(text, ' ', '-');
    return text;
  }
};

/// A machine of every kind of scheme, memory and interconnect, of six nodes. The
/// periods of all clocks are different and below 10 ticks. `assignment` is that of the image schemes.
[[nodiscard]] std::vector<NamedTiming> machines_of_every_kind(
    processors::machine::Assignment assignment = processors::machine::Assignment::dynamic);

/// Multiplies every duration of the machine by `factor`; false when a clock's period would not fit.
[[nodiscard]] bool stretch(processors::machine::MachineConfig& machine, std::int64_t factor);

/// Whether `long_one` is `short_one` with every time multiplied by `factor`, and everything else equal.
[[nodiscard]] bool is_stretched(const processors::replay::MachineResult& short_one,
                                const processors::replay::MachineResult& long_one, std::int64_t factor);

/// Sets all cycle counts of a machine to 0, and with them every duration that is given in cycles.
void take_all_time_away(processors::machine::MachineConfig& machine);

/// Whether both have the same hits and misses at every node.
[[nodiscard]] bool same_references(const processors::replay::MachineResult& a,
                                   const processors::replay::MachineResult& b);

}  // namespace marti::studies::stability
