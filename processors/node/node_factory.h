// The implementation of make_node_array: chooses the look-up code for a cache configuration. Each kind of
// node instantiates it in a source file of its own, because that takes long to compile.
#pragma once

#include <memory>

#include "memory/quad_tags.h"
#include "memory/set_tags.h"
#include "processors/node/node_array.h"
#include "processors/walk/node_caches.h"

namespace marti::processors::node {

[[nodiscard]] std::unique_ptr<NodeArray> make_image_nodes(const walk::ReplayInput& input, sim::Engine& engine,
                                                          Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_context_nodes(const walk::ReplayInput& input,
                                                            sim::Engine& engine, Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_dynamic_nodes(const walk::ReplayInput& input,
                                                            sim::Engine& engine, Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_context_building_nodes(const walk::ReplayInput& input,
                                                                     sim::Engine& engine, Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_stripped_nodes(const walk::ReplayInput& input,
                                                             sim::Engine& engine, Host& host);

/// Whether the nodes need code for several contexts or for prefetching.
[[nodiscard]] bool has_context_nodes(const walk::ReplayInput& input);

/// Nodes that can count more than hits and misses.
[[nodiscard]] std::unique_ptr<NodeArray> make_counted_nodes(const walk::ReplayInput& input,
                                                            sim::Engine& engine, Host& host);

/// Returns make(caches) with the caches of `config`, a class of node_caches.h. Each class of caches is
/// compiled once for each kind of node, so only the commonest caches have a class of their own: unified LRU
/// caches with few ways.
template <class Make>
auto with_caches(const machine::MachineConfig& config, const Make& make) {
  if (config.cache.organisation == machine::CacheOrganisation::none) {
    return make(walk::NoCaches{});
  }
  const memory::CacheConfig& cache = config.cache.cache;
  if (config.cache.organisation == machine::CacheOrganisation::unified &&
      cache.replacement == memory::Replacement::lru) {
    const memory::CacheShape shape = memory::shape_of(cache);
    switch (shape.ways) {
      case 1:
        return make(walk::UnifiedCaches<memory::SetTags<memory::Replacement::lru, 1>>(config, shape));
      case 2:
        return make(walk::UnifiedCaches<memory::SetTags<memory::Replacement::lru, 2>>(config, shape));
      case 4:
        return make(walk::UnifiedCaches<memory::QuadTags>(config, shape));
      case 8:
        return make(walk::UnifiedCaches<memory::SetTags<memory::Replacement::lru, 8>>(config, shape));
      default:
        break;
    }
  }
  return make(walk::AnyCaches(config));
}

template <template <class> class Nodes>
std::unique_ptr<NodeArray> make_nodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host) {
  return with_caches(input.config, [&]<class Caches>(Caches caches) -> std::unique_ptr<NodeArray> {
    return std::make_unique<Nodes<Caches>>(input, engine, host, std::move(caches));
  });
}

/// As make_nodes(), but with caches that never replace a line where the replay may use them. For nodes that
/// only look lines up and bring them in.
template <template <class> class Nodes>
std::unique_ptr<NodeArray> make_plain_nodes(const walk::ReplayInput& input, sim::Engine& engine, Host& host) {
  if (input.line_set != 0) {
    return std::make_unique<Nodes<walk::NonReplacingCaches>>(
        input, engine, host, walk::NonReplacingCaches(input.config, input.line_set));
  }
  return make_nodes<Nodes>(input, engine, host);
}

}  // namespace marti::processors::node
