// Random machines for the tests of estimates.
#pragma once

#include <cstdint>

#include "tests/support/random_machine.h"

namespace marti::test {

/// A machine that every method of estimating can answer for.
inline processors::machine::MachineConfig plain_machine(Random& random) {
  processors::machine::MachineConfig machine;
  machine.nodes = static_cast<std::uint32_t>(pick(random, 1, 9));
  machine.packets = {static_cast<std::uint32_t>(pick(random, 1, 4)),
                     static_cast<std::uint32_t>(pick(random, 1, 4)),
                     static_cast<processors::machine::PacketOrder>(pick(random, 0, 2))};
  machine.cache.cache = {.size = 32ULL << pick(random, 0, 8), .line = 32, .ways = 1};
  return machine;
}

}  // namespace marti::test
