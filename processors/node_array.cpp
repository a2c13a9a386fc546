#include "processors/node_array.h"

#include "processors/node_factory.h"

namespace marti::processors {

std::unique_ptr<NodeArray> make_node_array(const ReplayInput& input, sim::Engine& engine, Host& host) {
  if (input.config.count.any()) {
    return make_counted_nodes(input, engine, host);
  }
  return input.tree != nullptr ? make_dynamic_nodes(input, engine, host)
                               : make_image_nodes(input, engine, host);
}

}  // namespace marti::processors
