#include <string>
#include <vector>

#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

void declare_network_keys(sim::Schema& schema) {
  schema.section(
      "network",
      "messages between the nodes of a cluster, for rays that move and for a distributed database");
  schema.choice(
      "network.kind", "mesh", names(memory::network_kind_names),
      "ideal: fixed latency, no queue; bus: one message at a time; crossbar: a link into each node; mesh: a "
      "rectangle of routers; hypercube");
  schema.frequency("network.clock", "33 MHz", {"1 Hz", "1 THz"}, "clock of the network");
  schema.size("network.width", "4 B", {"1 B", "64 KiB"}, "bytes that a link moves in a beat");
  cycles(schema, "network.cycles_per_beat", 1, "cycles of each beat");
  cycles(schema, "network.hop_cycles", 2,
         "latency of each link of the way; ideal, bus and crossbar: of the whole way");
}

memory::NetworkConfig read_network(sim::Config& config) {
  memory::NetworkConfig network;
  network.kind = config.choice_as<memory::NetworkKind>("network.kind");
  network.clock = clock(config, "network.clock");
  network.hop_cycles = config.integer("network.hop_cycles");
  if (network.kind == memory::NetworkKind::ideal) {
    config.mark_unused_reason("network", "an ideal network has no links (network.kind = \"ideal\")",
                              "network.kind");
    return network;
  }
  network.width = static_cast<std::uint32_t>(config.size("network.width"));
  network.cycles_per_beat = config.integer("network.cycles_per_beat");
  return network;
}

}  // namespace marti::studies::keys
