// The configuration of `marti study stability`: how large its cases are, and nothing else.
#pragma once

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/stability/stability_case.h"

namespace marti::studies {

void declare_stability_keys(sim::Schema& schema);

/// The schema of `marti study stability`: these keys only. Its scenes and machines are its own.
[[nodiscard]] sim::Schema stability_schema();

/// Throws UserError naming file, line and key.
[[nodiscard]] CaseSize read_stability(sim::Config& config);

}  // namespace marti::studies
