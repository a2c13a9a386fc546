// What the regions of the space scheme cost to compute, from a pre-pass over few pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/flow/space/region_map.h"
#include "processors/program/work_log.h"
#include "sim/time.h"

namespace marti::processors {

struct RegionWork {
  std::vector<std::uint64_t> of;  ///< ticks in each region
  sim::Ticks total = 0;           ///< of the whole pre-pass, rays that enter no region included
};

/// The computing of every `step`-th pixel, from 0 on, of every `step`-th row. Memory and messages are not
/// part of it. A step is done in the region where its ray is: a ray is where it last visited a node, or where
/// it was made, or, coming from the host, in the first region on its way.
[[nodiscard]] RegionWork sample_work(const WorkLog& log, const RegionMap& regions, const StepTicks& ticks,
                                     std::uint32_t step);

}  // namespace marti::processors
