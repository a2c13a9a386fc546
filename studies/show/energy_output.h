// What the summary says about energy.
#pragma once

#include <string>

#include "studies/run/run_result.h"

namespace marti::studies::show {

/// Energy and power of the frame, its parts, the machine's area; empty where no energy is worked out.
[[nodiscard]] std::string energy_lines(const run::RunResult& result);

}  // namespace marti::studies::show
