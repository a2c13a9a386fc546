// What the nodes of all schemes in which rays move have in common, and what they are made with.
#pragma once

#include <vector>

#include "memory/network.h"
#include "processors/flow/flow_host.h"
#include "processors/flow/flow_result.h"
#include "processors/node/node_array.h"

namespace marti::processors {

/// Event classes of these schemes. At equal times progress inside a node comes first, then what was sent or
/// has ended, then what wakes a node, then the host, then the memory. Those they share with the image scheme
/// keep their numbers, because the memory posts them.
enum class FlowEvent : std::uint8_t {
  step = static_cast<std::uint8_t>(EventClass::step),
  reply = static_cast<std::uint8_t>(EventClass::reply),
  read = static_cast<std::uint8_t>(EventClass::read),
  done = 8,    ///< a node has finished what it did for a ray
  wake = 9,    ///< a node without work looks for some
  admit = 10,  ///< the host looks for camera rays that it may send; the component is the cluster
  memory = 11  ///< EventClass::memory
};

/// The nodes of all clusters, between which rays move.
class FlowNodes : public NodeArray {
 public:
  /// After finish(): fills in what these schemes count, beside what the host and the networks know.
  virtual void report(FlowResult& result) const = 0;
};

/// What such nodes are made with; all of it outlives them.
struct FlowParts {
  const ReplayInput& input;
  sim::Engine& engine;
  FlowHost& host;
  std::vector<memory::Network*> networks;  ///< one a cluster; the host is port MachineConfig::nodes
};

}  // namespace marti::processors
