#include "studies/figures/memory_names.h"

namespace marti::studies::figures {

std::string interconnect_name(const processors::machine::MachineConfig& machine) {
  if (machine.placement == processors::machine::Placement::distributed) {
    const auto kind = static_cast<std::size_t>(machine.network.kind);
    return std::string(memory::network_kind_names[kind]) + " network";
  }
  switch (machine.interconnect.kind) {
    case memory::InterconnectKind::ideal:
      return "ideal interconnect";
    case memory::InterconnectKind::crossbar:
      return "crossbar";
    case memory::InterconnectKind::bus:
      break;
  }
  return "bus";
}

std::string bank_name(const processors::machine::MachineConfig& machine) {
  return machine.banks.dram ? "channel" : "bank";
}

}  // namespace marti::studies::figures
