// Which counts of the caches beyond hits and misses are kept; none by default.
#pragma once

#include <string_view>

namespace marti::processors::machine {

struct CountConfig {
  bool miss_classes = false;  ///< why first-level caches missed
  bool sharing = false;       ///< how many nodes of a cluster fetched each line
  bool attribution = false;  ///< references, misses and waits by record kind, tree level, ray kind and bounce
  bool working_set = false;  ///< misses of caches of other sizes and ways (processors/passes/working_set.h)

  /// Whether nodes count anything while they are timed; the working set is worked out afterwards.
  [[nodiscard]] bool any() const { return miss_classes || sharing || attribution; }
};

/// The key of the first count that is asked for, for messages. At least one must be.
[[nodiscard]] std::string_view key_of(const CountConfig& count);

}  // namespace marti::processors::machine
