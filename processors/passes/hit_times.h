// What pixels take on a node all of whose references hit: the part of a machine's time that depends neither
// on its caches nor on its interconnect.
#pragma once

#include <span>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/walk/observer.h"
#include "sim/time.h"

namespace marti::processors {

/// One time for each of `pixels`. `config` must have a given tree, one context and no second level of caches.
[[nodiscard]] std::vector<sim::Ticks> hit_times(const WorkLog& log, const MachineConfig& config,
                                                std::span<const PixelPlace> pixels);

}  // namespace marti::processors
