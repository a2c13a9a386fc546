#include "processors/node/image_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/walk/counted_caches.h"

namespace marti::processors {

std::unique_ptr<NodeArray> make_counted_nodes(const ReplayInput& input, sim::Engine& engine, Host& host) {
  if (input.config.cache.organisation == CacheOrganisation::none) {
    return std::make_unique<ImageNodes<CountedCaches<false>>>(input, engine, host,
                                                              CountedCaches<false>(input));
  }
  return std::make_unique<ImageNodes<CountedCaches<true>>>(input, engine, host, CountedCaches<true>(input));
}

}  // namespace marti::processors
