// The list of the resources of a machine.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/replay/replay.h"
#include "studies/helps/resource.h"

namespace marti::studies::helps {

/// What the list depends on beside the machine.
struct FrameFacts {
  std::uint64_t packets = 0;
  std::uint64_t pixels = 0;
  std::uint64_t database_bytes = 0;
  bool writes_waited = true;     ///< a node has waited for room in its write buffer
  bool waited_for_banks = true;  ///< an access has waited for its bank
};

[[nodiscard]] FrameFacts facts_of(const processors::replay::MachineResult& result);

/// The resources that this machine has and that can be made better, in a fixed order. `changer` is of the
/// configuration of `machine`, `facts` of the frame it was timed on.
[[nodiscard]] std::vector<Resource> resources_of(const Changer& changer,
                                                 const processors::machine::MachineConfig& machine,
                                                 const FrameFacts& facts);

}  // namespace marti::studies::helps
