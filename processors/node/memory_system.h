// The memory system of a cluster.
#pragma once

#include <memory>

#include "memory/distributed.h"
#include "memory/interconnect.h"
#include "processors/machine/machine_config.h"

namespace marti::processors::node {

/// The interconnect and banks of a shared memory, or a distributed memory, depending on the placement of the
/// database. The site's engine and client must outlive it; the site's ports are those of the cluster's nodes,
/// the same number for each node.
[[nodiscard]] std::unique_ptr<memory::Interconnect> make_memory_system(const machine::MachineConfig& config,
                                                                       const memory::InterconnectSite& site);

/// The configuration that make_memory_system gives a distributed memory.
[[nodiscard]] memory::DistributedConfig distributed_config(const machine::MachineConfig& config);

/// Whether the nodes reach their cluster's memory over links that can be busy.
[[nodiscard]] bool has_links(const machine::MachineConfig& config);

}  // namespace marti::processors::node
