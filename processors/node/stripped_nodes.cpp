#include "processors/node/image_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/walk/stripped_walker.h"

namespace marti::processors::node {

namespace {

template <class Caches>
using StrippedNodes = ImageNodes<Caches, walk::StrippedWalker<Caches>>;

}  // namespace

std::unique_ptr<NodeArray> make_stripped_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                               Host& host) {
  return make_plain_nodes<StrippedNodes>(input, engine, host);
}

}  // namespace marti::processors::node
