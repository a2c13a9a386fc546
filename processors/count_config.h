// What is counted about caches beside hits and misses, as values; all of it only when asked.
#pragma once

namespace marti::processors {

struct CountConfig {
  bool miss_classes = false;  ///< why first-level caches missed
  bool sharing = false;       ///< how many nodes of a cluster fetched each line
  bool attribution = false;  ///< references, misses and waits by record kind, tree level, ray kind and bounce

  [[nodiscard]] bool any() const { return miss_classes || sharing || attribution; }
};

}  // namespace marti::processors
