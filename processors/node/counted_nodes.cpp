#include <utility>

#include "processors/node/context_building_nodes.h"
#include "processors/node/context_nodes.h"
#include "processors/node/dynamic_nodes.h"
#include "processors/node/image_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/walk/counted_caches.h"

namespace marti::processors::node {

std::unique_ptr<NodeArray> make_counted_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                              Host& host) {
  return walk::with_counted_caches(input, [&]<class Caches>(Caches caches) -> std::unique_ptr<NodeArray> {
    const bool contexts = has_context_nodes(input);
    if (input.tree != nullptr && contexts) {
      return std::make_unique<ContextBuildingNodes<Caches>>(input, engine, host, std::move(caches));
    }
    if (input.tree != nullptr) {
      return std::make_unique<DynamicNodes<Caches>>(input, engine, host, std::move(caches));
    }
    if (contexts) {
      return std::make_unique<ContextNodes<Caches>>(input, engine, host, std::move(caches));
    }
    return std::make_unique<ImageNodes<Caches>>(input, engine, host, std::move(caches));
  });
}

}  // namespace marti::processors::node
