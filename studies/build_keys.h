// The configuration keys of how the tree is built.
#pragma once

#include "processors/build_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies {

void declare_build_keys(sim::Schema& schema);

/// Reads the keys and marks those without effect. Throws UserError naming file, line and key, also when the
/// chosen structure (`structure.kind`) is not built by splitting nodes or the database's placement leaves no
/// tree to share.
[[nodiscard]] processors::BuildConfig read_build(sim::Config& config);

}  // namespace marti::studies
