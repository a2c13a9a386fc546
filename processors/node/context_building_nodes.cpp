#include "processors/node/context_building_nodes.h"

#include "processors/node/node_factory.h"

namespace marti::processors::node {

std::unique_ptr<NodeArray> make_context_building_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                                       Host& host) {
  return make_nodes<ContextBuildingNodes>(input, engine, host);
}

}  // namespace marti::processors::node
