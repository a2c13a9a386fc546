// The configuration keys of a sweep: [sweep].
#pragma once

#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::sweep {

/// The keys of [sweep] and of [prices]; read_sweep_table (sweep/plan/sweep_table.h) reads what else [sweep]
/// holds.
void declare_sweep_keys(sim::Schema& schema);

/// The schema of `marti sweep`, made once.
[[nodiscard]] const sim::Schema& sweep_schema();

/// Throws UserError when something is to be recorded: a sweep has no directory for each machine.
void refuse_records(sim::Config& config);

}  // namespace marti::studies::sweep
