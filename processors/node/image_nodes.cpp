#include "processors/node/image_nodes.h"

#include "processors/node/node_factory.h"
#include "processors/walk/log_walker.h"

namespace marti::processors::node {

namespace {

// Has one parameter, as make_nodes needs: not every compiler ignores a further one that has a default.
template <class Caches>
using LoggedNodes = ImageNodes<Caches, walk::LogWalker<Caches>>;

}  // namespace

std::unique_ptr<NodeArray> make_image_nodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host) {
  return make_plain_nodes<LoggedNodes>(input, engine, host);
}

}  // namespace marti::processors::node
