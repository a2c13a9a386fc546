// Inside of make_node_array: chooses the look-up code that a cache configuration asks for. Each kind of node
// instantiates it in a source file of its own, because that takes long to compile.
#pragma once

#include <algorithm>
#include <array>
#include <memory>

#include "processors/node_array.h"
#include "processors/node_caches.h"

namespace marti::processors {

[[nodiscard]] std::unique_ptr<NodeArray> make_image_nodes(const ReplayInput& input, sim::Engine& engine,
                                                          Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_context_nodes(const ReplayInput& input, sim::Engine& engine,
                                                            Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_dynamic_nodes(const ReplayInput& input, sim::Engine& engine,
                                                            Host& host);
[[nodiscard]] std::unique_ptr<NodeArray> make_stripped_nodes(const ReplayInput& input, sim::Engine& engine,
                                                             Host& host);

/// For the counts that a run may be asked for beside hits and misses.
[[nodiscard]] std::unique_ptr<NodeArray> make_counted_nodes(const ReplayInput& input, sim::Engine& engine,
                                                            Host& host);

/// make(caches) with the caches of `config`, one of node_caches.h.
template <class Make>
auto with_caches(const MachineConfig& config, const Make& make) {
  const memory::CacheConfig& cache = config.cache.cache;
  if (config.cache.organisation == CacheOrganisation::none) {
    return make(NoCaches{});
  }
  if (config.cache.organisation == CacheOrganisation::unified) {
    const memory::CacheShape shape = memory::shape_of(cache);
    return memory::with_tag_store(cache.replacement, shape,
                                  [&]<class Tags>() { return make(UnifiedCaches<Tags>(config, shape)); });
  }
  std::array<memory::CacheShape, split_caches> shapes;
  for (std::size_t i = 0; i < split_caches; ++i) {
    memory::CacheConfig part = cache;
    part.size = config.cache.split_sizes[i];
    shapes[i] = memory::shape_of(part);
  }
  // The tag store must suit all four: where their ways differ, only the hashed one does.
  memory::CacheShape common = shapes[0];
  if (std::any_of(shapes.begin(), shapes.end(), [&](const auto& s) { return s.ways != common.ways; })) {
    common.ways = memory::most_searched_ways + 1;
  }
  return memory::with_tag_store(cache.replacement, common,
                                [&]<class Tags>() { return make(SplitCaches<Tags>(config, shapes)); });
}

template <template <class> class Nodes>
std::unique_ptr<NodeArray> make_nodes(const ReplayInput& input, sim::Engine& engine, Host& host) {
  return with_caches(input.config, [&]<class Caches>(Caches caches) -> std::unique_ptr<NodeArray> {
    return std::make_unique<Nodes<Caches>>(input, engine, host, std::move(caches));
  });
}

}  // namespace marti::processors
