// The list of the resources of a machine.
#pragma once

#include <vector>

#include "processors/replay/replay.h"
#include "studies/helps/resource.h"

namespace marti::studies {

/// The resources that this machine has and that can be made better, in a fixed order. `changer` is of the
/// configuration of `machine`, `result` the frame it was timed on.
[[nodiscard]] std::vector<Resource> resources_of(const Changer& changer,
                                                 const processors::MachineConfig& machine,
                                                 const processors::MachineResult& result);

}  // namespace marti::studies
