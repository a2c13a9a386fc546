// What first-level caches of other sizes and ways would have missed, exactly, from one pass over the
// references of each node.
//
// A cache changes how long a node takes, never what it refers to. So for the packets that a node was handed
// out, one pass gives the misses of LRU caches of every size (memory/stack_distance.h) and of all ways
// (memory/all_ways.h). Which packets these are follows from the configuration alone with one node and with
// interleaved or blocks assignment: the misses are then those of a machine with the other cache. With dynamic
// assignment a machine with another cache hands its packets out in another way, and what is counted here are
// the misses of the other cache for the packets as this machine handed them out.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/all_ways.h"
#include "memory/cache_config.h"
#include "memory/stack_distance.h"
#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "processors/walk/handed_out.h"

namespace marti::processors {

/// Sums over all nodes' caches of one kind. Pixel writes bypass caches and are not in it.
struct CacheWorkingSet {
  memory::CacheShape shape;          ///< of the machine's own cache
  memory::StackHistogram distances;  ///< fully associative LRU caches of all sizes
  memory::WaysHistogram ways;        ///< LRU caches of the machine's number of sets; empty with one set
};

struct WorkingSet {
  std::uint32_t line = 0;  ///< bytes
  bool any_cache = false;  ///< the packets of a node do not depend on its cache
  /// Of the unified cache, or of the split ones in the order of split_cache_names.
  std::vector<CacheWorkingSet> caches;
};

/// Ways of a set are counted up to this number, or up to those of the machine when it has more.
inline constexpr std::uint32_t counted_ways = 16;
/// Caches of several sets may have so many ways at most.
inline constexpr std::uint32_t most_counted_ways = 4096;

/// Throws UserError with the reason when the working sets of the machine's nodes cannot be told.
void check_working_set(const MachineConfig& config);

/// After the replay of a machine that passes check_working_set(), with the log still there. `threads` host
/// threads (0: all) share the nodes; the result does not depend on them.
[[nodiscard]] WorkingSet working_set(const HandedOut& handed_out, unsigned threads = 0);

/// Throws InternalError unless the machine's own counts are those of the pass: all references, with LRU all
/// misses, and with another replacement no fewer than first uses.
void check_working_set(const WorkingSet& set, const MachineConfig& config, const MachineResult& result);

}  // namespace marti::processors
