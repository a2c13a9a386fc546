// The resources of machines in which rays move, and of networks.
#pragma once

#include <vector>

#include "studies/helps/resource.h"

namespace marti::studies::helps {

/// Adds the network, for rays that move or a distributed database; messages, queues and the rays in flight;
/// the nodes of each stage of a pipeline, which are added to the machine; the level at which space is cut.
void add_flow(const Changer& changer, const processors::machine::MachineConfig& machine,
              std::vector<Resource>& resources);

}  // namespace marti::studies::helps
