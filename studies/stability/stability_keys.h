// The configuration of `marti study stability`: how large its cases are, and nothing else.
#pragma once

#include <span>
#include <vector>

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/stability/stability_case.h"

namespace marti::studies::stability {

void declare_stability_keys(sim::Schema& schema);

/// The schema of `marti study stability`: these keys only. Its scenes and machines are its own.
[[nodiscard]] sim::Schema stability_schema();

struct StabilityConfig {
  CaseSize size;
  std::vector<StabilityCase> cases;  ///< those chosen, in the order of all cases
};

/// Throws UserError naming file, line and key.
[[nodiscard]] StabilityConfig read_stability(sim::Config& config, std::span<const StabilityCase> all);

}  // namespace marti::studies::stability
