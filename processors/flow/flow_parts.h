// The interface of the nodes in all schemes in which rays move, and the objects that they are made with.
#pragma once

#include <vector>

#include "memory/network.h"
#include "processors/flow/flow_host.h"
#include "processors/flow/flow_result.h"
#include "processors/node/node_array.h"

namespace marti::processors::flow {

/// Event classes of these schemes. At equal times the order is: progress inside a node, arrivals and
/// completions, events that wake a node, the host, the memory. Classes shared with the image scheme keep
/// their numbers, because the memory posts them.
enum class FlowEvent : std::uint8_t {
  step = static_cast<std::uint8_t>(node::EventClass::step),
  reply = static_cast<std::uint8_t>(node::EventClass::reply),
  read = static_cast<std::uint8_t>(node::EventClass::read),
  done = 8,    ///< a node has finished its work on a ray
  wake = 9,    ///< a node without work looks for a ray
  admit = 10,  ///< the host looks for camera rays that it may send; the component is the cluster
  memory = 11  ///< EventClass::memory
};

/// The nodes of all clusters, between which rays move.
class FlowNodes : public node::NodeArray {
 public:
  /// Fills in what the nodes have counted; the counts of the host and the networks are left to the caller.
  virtual void report(FlowResult& result) const = 0;
};

/// The objects that such nodes are made with; all of them outlive the nodes.
struct FlowParts {
  const walk::ReplayInput& input;
  sim::Engine& engine;
  FlowHost& host;
  std::vector<memory::Network*> networks;  ///< one a cluster; the host is port MachineConfig::nodes
};

}  // namespace marti::processors::flow
