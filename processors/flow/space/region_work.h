// The compute time in each region of the space scheme, from a pre-pass over few pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/flow/space/region_map.h"
#include "processors/program/work_log.h"
#include "sim/time.h"

namespace marti::processors::flow {

struct RegionWork {
  std::vector<std::uint64_t> of;  ///< ticks in each region
  sim::Ticks total = 0;           ///< ticks of the whole pre-pass, including rays that enter no region
};

/// The compute time of every `step`-th pixel of every `step`-th row, both from 0 on, without memory and
/// messages. A step counts for the region that its ray visited last; before its first visit, for the region
/// where the ray was made or, for a camera ray, the first region on its way.
[[nodiscard]] RegionWork sample_work(const program::WorkLog& log, const RegionMap& regions,
                                     const cost::StepTicks& ticks, std::uint32_t step);

}  // namespace marti::processors::flow
