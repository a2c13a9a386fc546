// Which memory system stands behind the nodes of a cluster.
#pragma once

#include <memory>

#include "memory/distributed.h"
#include "memory/interconnect.h"
#include "processors/machine/machine_config.h"

namespace marti::processors {

/// The interconnect and banks of a shared memory, or a distributed memory, as the placement of the database
/// says. Engine and client of the site must outlive it; the site's ports are those of the cluster's nodes, as
/// many for each.
[[nodiscard]] std::unique_ptr<memory::Interconnect> make_memory_system(const MachineConfig& config,
                                                                       const memory::InterconnectSite& site);

/// What make_memory_system gives to a distributed memory.
[[nodiscard]] memory::DistributedConfig distributed_config(const MachineConfig& config);

/// Whether the nodes reach their cluster's memory over links that can be busy.
[[nodiscard]] bool has_links(const MachineConfig& config);

}  // namespace marti::processors
