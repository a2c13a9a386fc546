#include "processors/machine_config.h"

#include <bit>
#include <string>

#include "sim/error.h"

namespace marti::processors {

void check(const MachineConfig& config) {
  if (config.clusters == 0 || config.nodes == 0) {
    throw sim::UserError("a machine needs at least one cluster of one node");
  }
  if (std::uint64_t{config.clusters} * config.nodes > most_nodes) {
    throw sim::UserError("a machine of more than 2^24 nodes");
  }
  if (config.write_buffer == 0 || config.word_bytes == 0) {
    throw sim::UserError("the write buffer and the word must not be empty");
  }
  if (config.placement == Placement::replicated && config.local.width == 0) {
    throw sim::UserError("local memory must be at least one byte wide");
  }
  if (config.cache.organisation == CacheOrganisation::unified) {
    (void)memory::shape_of(config.cache.cache);
  }
  if (config.cache.organisation == CacheOrganisation::split) {
    for (std::size_t i = 0; i < split_caches; ++i) {
      memory::CacheConfig part = config.cache.cache;
      part.size = config.cache.split_sizes[i];
      try {
        (void)memory::shape_of(part);
      } catch (const sim::UserError& error) {
        throw sim::UserError("the " + std::string(split_cache_names[i]) + " cache: " + error.what());
      }
    }
  }
}

}  // namespace marti::processors
