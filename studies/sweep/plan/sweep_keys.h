// The configuration keys of a sweep: [sweep] and [prices].
#pragma once

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/sweep/plan/sweep_cost.h"

namespace marti::studies {

/// The keys of both sections; read_sweep_table (sweep/plan/sweep_table.h) reads what else [sweep] holds.
void declare_sweep_keys(sim::Schema& schema);

/// The schema of `marti sweep`.
[[nodiscard]] sim::Schema sweep_schema();

/// Throws UserError for an unknown key of [prices].
[[nodiscard]] Prices read_prices(const sim::Config& config);

/// Throws UserError when something is to be recorded: a sweep has no directory for each machine.
void refuse_records(sim::Config& config);

}  // namespace marti::studies
