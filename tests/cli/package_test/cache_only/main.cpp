// A project of its own that uses the cache model alone.
#include <cstdio>

#include "memory/cache.h"
#include "sim/error.h"

int main() {
  marti::memory::CacheConfig config;
  config.size = 128;
  config.line = 32;
  config.ways = 2;  // two sets of two lines
  marti::memory::Cache cache(config);
  cache.read(0, 32);                         // miss
  cache.read(16, 32);                        // hit in line 0, miss in line 1
  cache.read(64, 4);                         // miss; set 0 holds lines 0 and 2
  cache.read(0, 4);                          // hit; line 2 is now the older one
  cache.read(128, 4);                        // miss; line 4 replaces line 2
  const auto replaced = cache.read(64, 4);   // miss
  const auto last = cache.read(128 + 4, 4);  // hit
  const bool right = cache.counters().hits == 3 && cache.counters().misses == 5 && replaced == 1 && last == 0;

  bool refused = false;
  try {
    config.line = 48;
    const marti::memory::Cache impossible(config);
  } catch (const marti::sim::UserError&) {
    refused = true;
  }
  std::printf("hits %lld, misses %lld\n", static_cast<long long>(cache.counters().hits),
              static_cast<long long>(cache.counters().misses));
  return right && refused ? 0 : 1;
}
