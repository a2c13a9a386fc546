#include "processors/node_array.h"

#include <algorithm>

#include "processors/dynamic_nodes.h"
#include "processors/image_nodes.h"

namespace marti::processors {

namespace {

template <class Caches>
std::unique_ptr<NodeArray> make(const ReplayInput& input, sim::Engine& engine, Host& host, Caches caches) {
  if (input.tree != nullptr) {
    return std::make_unique<DynamicNodes<Caches>>(input, engine, host, std::move(caches));
  }
  return std::make_unique<ImageNodes<Caches>>(input, engine, host, std::move(caches));
}

}  // namespace

std::unique_ptr<NodeArray> make_node_array(const ReplayInput& input, sim::Engine& engine, Host& host) {
  const MachineConfig& config = input.config;
  const memory::CacheConfig& cache = config.cache.cache;
  if (config.cache.organisation == CacheOrganisation::none) {
    return make(input, engine, host, NoCaches{});
  }
  if (config.cache.organisation == CacheOrganisation::unified) {
    const memory::CacheShape shape = memory::shape_of(cache);
    return memory::with_tag_store(cache.replacement, shape, [&]<class Tags>() {
      return make(input, engine, host, UnifiedCaches<Tags>(config, shape));
    });
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
  return memory::with_tag_store(cache.replacement, common, [&]<class Tags>() {
    return make(input, engine, host, SplitCaches<Tags>(config, shapes));
  });
}

}  // namespace marti::processors
