#include "processors/node/context_nodes.h"

#include "processors/node/node_factory.h"

namespace marti::processors::node {

std::unique_ptr<NodeArray> make_context_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                              Host& host) {
  return make_nodes<ContextNodes>(input, engine, host);
}

}  // namespace marti::processors::node
