#include "processors/node_array.h"

#include "processors/node_factory.h"

namespace marti::processors {

std::unique_ptr<NodeArray> make_node_array(const ReplayInput& input, sim::Engine& engine, Host& host) {
  if (input.config.count.any()) {
    return make_counted_nodes(input, engine, host);
  }
  if (input.tree != nullptr) {
    return make_dynamic_nodes(input, engine, host);
  }
  const bool contexts = input.with_contexts || input.config.contexts > 1 || input.config.prefetch.on();
  return contexts ? make_context_nodes(input, engine, host) : make_image_nodes(input, engine, host);
}

}  // namespace marti::processors
