#include "processors/node/node_array.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "processors/node/node_factory.h"
#include "processors/walk/counted_caches.h"
#include "sim/error.h"

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

bool can_be_parts(const walk::ReplayInput& input) {
  return input.config.kind == machine::NodeKind::core && input.tree == nullptr && input.sample == nullptr &&
         input.observer == nullptr && !has_context_nodes(input) && !walk::needs_counted_caches(input);
}

void NodeArray::run_before(sim::Engine& /*engine*/, sim::Ticks /*end*/) {
  throw sim::InternalError("nodes that are not made for it are a part of a machine");
}

void NodeArray::grant(std::uint32_t /*node*/, const std::optional<Grant>& /*grant*/) {
  throw sim::InternalError("nodes that do not ask later are given a packet");
}

void NodeArray::end_not_before(sim::Ticks /*end*/) {
  throw sim::InternalError("nodes that are no part of a machine end with another part");
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
