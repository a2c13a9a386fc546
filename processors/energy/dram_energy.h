// What memories of DRAM take of energy.
#pragma once

#include <cstddef>
#include <string_view>

namespace marti::processors::energy {

/// Without what a channel takes beside its accesses: refresh, background, controller.
struct DramEnergy {
  double activation = 0.0;  ///< pJ to open and close a row
  double read = 0.0;        ///< pJ of a byte read
  double write = 0.0;       ///< pJ of a byte written
  std::string_view source;  ///< of these figures, as a summary says it
};

/// Of the memory with this index in memory::dram_preset_names.
[[nodiscard]] const DramEnergy& dram_energy(std::size_t preset);

}  // namespace marti::processors::energy
