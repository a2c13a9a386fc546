// The private first-level caches of one node, each a cache of its own.
#pragma once

#include <vector>

#include "memory/cache.h"
#include "processors/machine/machine_config.h"
#include "processors/walk/node_caches.h"

namespace marti::test {

/// Caches of random replacement draw from a stream for each node and are not for this model.
class NaiveCaches {
 public:
  explicit NaiveCaches(const processors::machine::MachineConfig& machine) {
    using processors::machine::CacheOrganisation;
    if (machine.cache.organisation == CacheOrganisation::unified) {
      caches_.emplace_back(machine.cache.cache);
    } else if (machine.cache.organisation == CacheOrganisation::split) {
      for (const std::uint64_t size : machine.cache.split_sizes) {
        memory::CacheConfig part = machine.cache.cache;
        part.size = size;
        caches_.emplace_back(part);
      }
    }
  }

  [[nodiscard]] bool present() const { return !caches_.empty(); }
  /// The number of the cache that a record kind uses.
  [[nodiscard]] std::size_t number_of(memory::RecordKind kind) const {
    return caches_.size() > 1 ? processors::walk::split_cache_of[static_cast<std::size_t>(kind)] : 0;
  }
  /// A reference: whether it hits. A line that is missing is brought in.
  bool refer(memory::RecordKind kind, memory::Address address) {
    return present() && caches_[number_of(kind)].read(address, 1) == 0;
  }

 private:
  std::vector<memory::Cache> caches_;
};

}  // namespace marti::test
