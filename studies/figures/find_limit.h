// Where most of the nodes' time goes.
#pragma once

#include <string>
#include <string_view>

#include "processors/replay/replay.h"

namespace marti::studies::figures {

/// What connects the nodes to their memory: "ideal interconnect", "bus", "crossbar", or for a distributed
/// database "mesh network" and the like.
[[nodiscard]] std::string interconnect_name(const processors::machine::MachineConfig& machine);

/// What serves the memory's accesses one after another: "bank", or with DRAM "channel".
[[nodiscard]] std::string bank_name(const processors::machine::MachineConfig& machine);

enum class Limit {
  nothing,
  interconnect,
  bank,
  memory_latency,
  dispatch,
  start_up,
  lock,
  imbalance,
  write_buffer,
  slowest_part,
  queues,
  messages,
  compute
};

/// Where most of the nodes' time goes. It does not say what would help: studies/helps measures that.
[[nodiscard]] Limit find_limit(const processors::machine::MachineConfig& machine,
                               const processors::replay::MachineResult& result);

/// The name of a limit in results for programs.
[[nodiscard]] std::string_view name_of(Limit limit);

}  // namespace marti::studies::figures
