// The configuration keys of what hides a node's misses: contexts and prefetching.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

/// Declares these keys of section `node`.
void declare_context_keys(sim::Schema& schema);
/// Declares section `prefetch`.
void declare_prefetch_keys(sim::Schema& schema);

/// Reads both sections into a machine whose cache, placement and building have been read, and marks keys
/// without effect. Throws UserError naming file, line and key.
void read_contexts(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
