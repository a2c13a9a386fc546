// The configuration keys of how the tree is built.
#pragma once

#include "processors/machine/build_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_build_keys(sim::Schema& schema);

/// Reads the keys and marks those without effect. Throws UserError naming file, line and key, also when the
/// chosen structure (`structure.kind`) is not built by splitting nodes or the database's placement leaves no
/// tree to share.
[[nodiscard]] processors::machine::BuildConfig read_build(sim::Config& config);

/// For studies that always build on demand: like read_build, but if `build.sharing` is not given, the tree is
/// shared, or private where each node has a database of its own. Also throws UserError when `build.sharing`
/// is "given" or "none". Call it after read_machine.
[[nodiscard]] processors::machine::BuildConfig read_dynamic_build(sim::Config& config);

}  // namespace marti::studies::keys
