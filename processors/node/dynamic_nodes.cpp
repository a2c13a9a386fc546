#include "processors/node/dynamic_nodes.h"

#include "processors/node/node_factory.h"

namespace marti::processors::node {

std::unique_ptr<NodeArray> make_dynamic_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                              Host& host) {
  return make_nodes<DynamicNodes>(input, engine, host);
}

}  // namespace marti::processors::node
