#include "processors/node/dynamic_nodes.h"

#include "processors/node/node_factory.h"

namespace marti::processors {

std::unique_ptr<NodeArray> make_dynamic_nodes(const ReplayInput& input, sim::Engine& engine, Host& host) {
  return make_nodes<DynamicNodes>(input, engine, host);
}

}  // namespace marti::processors
