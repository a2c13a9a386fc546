// Fetching an object into the host's caches before it is needed.
#pragma once

#include <cstddef>

namespace marti::sim {

/// Prefetches all of `object` for writing. A hint: it affects nothing but speed.
template <class T>
void prefetch(const T& object) {
  const char* const bytes = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof(T); at += 64) {
    __builtin_prefetch(bytes + at, 1);
  }
}

}  // namespace marti::sim
