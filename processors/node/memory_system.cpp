#include "processors/node/memory_system.h"

#include "processors/walk/second_level.h"

namespace marti::processors::node {

memory::DistributedConfig distributed_config(const machine::MachineConfig& config) {
  return {config.nodes,
          config.distribution.interleave,
          config.distribution.header_bytes,
          config.local.clock,
          config.local.width,
          config.local.access_cycles,
          config.local.cycles_per_beat,
          config.network};
}

std::unique_ptr<memory::Interconnect> make_memory_system(const machine::MachineConfig& config,
                                                         const memory::InterconnectSite& site) {
  if (config.placement == machine::Placement::distributed) {
    return std::make_unique<memory::Distributed>(distributed_config(config), site);
  }
  return memory::make_interconnect(config.interconnect, walk::banks_of(config), site);
}

bool has_links(const machine::MachineConfig& config) {
  if (config.scheme == machine::Scheme::space) {
    return false;
  }
  return config.placement == machine::Placement::distributed
             ? config.network.kind != memory::NetworkKind::ideal
             : config.interconnect.kind != memory::InterconnectKind::ideal;
}

}  // namespace marti::processors::node
