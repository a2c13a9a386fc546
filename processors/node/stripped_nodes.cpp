#include "processors/node/image_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/walk/stripped_walker.h"

namespace marti::processors {

namespace {

template <class Caches>
using StrippedNodes = ImageNodes<Caches, StrippedWalker<Caches>>;

}  // namespace

std::unique_ptr<NodeArray> make_stripped_nodes(const ReplayInput& input, sim::Engine& engine, Host& host) {
  if (input.line_set != 0) {
    return std::make_unique<StrippedNodes<NonReplacingCaches>>(
        input, engine, host, NonReplacingCaches(input.config, input.line_set));
  }
  return make_nodes<StrippedNodes>(input, engine, host);
}

}  // namespace marti::processors
