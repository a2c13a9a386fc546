// What differs between a replay and the SystemC model of the same machine.
#pragma once

#include <string>
#include <vector>

#include "processors/replay/replay.h"
#include "tests/validation/systemc/machine.h"

namespace marti::oracle {

/// One line for each figure that differs: end, every counter of each node, cluster, bank and the host, and
/// all waits with their histograms. Empty if nothing differs.
[[nodiscard]] std::vector<std::string> differences(const processors::replay::MachineResult& replay,
                                                   const MachineFigures& systemc);

}  // namespace marti::oracle
