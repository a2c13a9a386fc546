// What two ranks of a sweep must agree on.
#pragma once

#include <string>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies {

/// A digest of program, frames and machines, the content of scenes included: 32 hexadecimal digits.
[[nodiscard]] std::string digest_of(const SweepPlan& plan);

}  // namespace marti::studies
