// What a machine costs.
#pragma once

#include "processors/machine/machine_config.h"

namespace marti::studies::keys {

/// Prices of a machine's parts, at least 0, in any unit. By default a node costs 1 and the other parts a
/// plausible fraction of that.
struct Prices {
  double cluster = 0.0;
  double node = 1.0;
  double context = 0.125;           ///< each beyond a node's first
  double cache_kib = 0.03125;       ///< first level, private or shared
  double l2_kib = 0.015625;         ///< second level
  double interconnect_byte = 0.25;  ///< of its width
  double network_byte = 0.125;      ///< of its width, a node
  double bank = 0.5;
};

/// The price of the whole machine: only of parts that it has. An ideal interconnect, which cannot be built,
/// costs nothing and has no banks.
[[nodiscard]] double cost_of(const Prices& prices, const processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
