// What first-level caches of other sizes and ways would have missed, exactly, from one pass over the
// references of each node.
//
// A cache changes how long a node takes, never what it refers to. So for the packets that a node was given,
// one pass yields the misses of LRU caches of every size (memory/stack_distance.h) and of all numbers of ways
// (memory/all_ways.h). With one node, and with interleaved or blocks assignment, the packets of a node follow
// from the configuration alone: the misses are then those of a machine with the other cache. With dynamic
// assignment a machine with another cache would hand its packets out differently; the misses counted here are
// those of the other cache for the packets as this machine handed them out.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/all_ways.h"
#include "memory/cache_config.h"
#include "memory/stack_distance.h"
#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "processors/walk/packets_of_nodes.h"

namespace marti::processors::passes {

/// Sums over all nodes' caches of one kind, without pixel writes, which bypass caches.
struct CacheWorkingSet {
  memory::CacheShape shape;          ///< of the machine's own cache
  memory::StackHistogram distances;  ///< fully associative LRU caches of all sizes
  memory::WaysHistogram ways;        ///< LRU caches of the machine's number of sets; empty with one set
};

struct WorkingSet {
  std::uint32_t line = 0;  ///< bytes
  bool any_cache = false;  ///< true when the packets of a node do not depend on its cache
  /// One for the unified cache, or one for each split cache in the order of split_cache_names.
  std::vector<CacheWorkingSet> caches;
};

/// The ways of a set are counted up to this number, or up to the machine's if it has more.
inline constexpr std::uint32_t counted_ways = 16;
/// The most ways that caches of several sets may have.
inline constexpr std::uint32_t most_counted_ways = 4096;

/// Throws UserError with the reason when the working sets of the machine's nodes cannot be determined.
void check_working_set(const machine::MachineConfig& config);

/// Bytes of the host's memory that one thread of working_set() takes for caches; 0 if none are asked for.
/// What it takes for each line of memory comes on top.
[[nodiscard]] std::uint64_t working_set_bytes(const machine::MachineConfig& config);

/// Call it after the replay of a machine that passes check_working_set(), while the log still exists.
/// `threads` host threads (0: all) share the nodes; the result does not depend on their number.
[[nodiscard]] WorkingSet working_set(const walk::PacketsOfNodes& packets_of_nodes, unsigned threads = 0);

/// Throws InternalError unless the machine's own counts agree with the pass: equal numbers of references;
/// with LRU equal misses, and with another replacement at least as many misses as first uses of lines.
void check_working_set(const WorkingSet& set, const machine::MachineConfig& config,
                       const replay::MachineResult& result);

}  // namespace marti::processors::passes
