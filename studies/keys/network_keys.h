// The configuration keys of the network between nodes.
#pragma once

#include "memory/network.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

void declare_network_keys(sim::Schema& schema);

/// Reads the network of a machine that has one, and marks the keys that its kind does not use.
[[nodiscard]] memory::NetworkConfig read_network(sim::Config& config);

}  // namespace marti::studies::keys
