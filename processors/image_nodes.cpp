#include "processors/image_nodes.h"

#include "processors/node_factory.h"

namespace marti::processors {

std::unique_ptr<NodeArray> make_image_nodes(const ReplayInput& input, sim::Engine& engine, Host& host) {
  return make_nodes<ImageNodes>(input, engine, host);
}

}  // namespace marti::processors
