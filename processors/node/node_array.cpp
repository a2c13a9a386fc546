#include "processors/node/node_array.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "processors/node/node_factory.h"
#include "processors/walk/counted_caches.h"

namespace marti::processors::node {

std::vector<std::uint32_t> order_drawn_from(std::uint64_t seed, std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  if (seed != 0) {
    std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
  }
  return order;
}

bool has_context_nodes(const walk::ReplayInput& input) {
  return input.with_contexts || input.config.contexts > 1 || input.config.prefetch.on();
}

std::unique_ptr<NodeArray> make_node_array(const walk::ReplayInput& input, sim::Engine& engine, Host& host) {
  if (input.stripped != nullptr) {
    return make_stripped_nodes(input, engine, host);
  }
  if (walk::needs_counted_caches(input)) {
    return make_counted_nodes(input, engine, host);
  }
  const bool contexts = has_context_nodes(input);
  if (input.tree != nullptr) {
    return contexts ? make_context_building_nodes(input, engine, host)
                    : make_dynamic_nodes(input, engine, host);
  }
  return contexts ? make_context_nodes(input, engine, host) : make_image_nodes(input, engine, host);
}

}  // namespace marti::processors::node
