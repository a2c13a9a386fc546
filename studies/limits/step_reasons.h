// Why the model says what it says about a part of the machine.
#pragma once

#include <string>

#include "processors/machine/machine_config.h"
#include "studies/helps/resource.h"
#include "studies/limits/point_figures.h"

namespace marti::studies::limits {

/// Whether the part is busy for 90 % of the frame or more: its interconnect's links on average, or a bank.
[[nodiscard]] bool is_full(helps::Part part, const processors::machine::MachineConfig& machine,
                           const PointFigures& figures);

/// "bound: the bus is 97.2 % busy", "model: nodes compute for 88.1 % of their time".
[[nodiscard]] std::string reason_of(helps::Part part, const processors::machine::MachineConfig& machine,
                                    const PointFigures& figures);

}  // namespace marti::studies::limits
