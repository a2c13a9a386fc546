// What building the tree took, and what trees there are at the end.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "processors/machine/build_config.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::processors::node {

/// The work of one processor node on the tree, before the frame and during it.
struct BuildCounts {
  std::int64_t start_up_splits = 0;
  std::int64_t splits = 0;
  std::int64_t locks = 0;
  std::int64_t waits = 0;
  std::int64_t rereads = 0;
  std::int64_t listed = 0;
  std::int64_t overlaps = 0;
  std::int64_t children = 0;
  std::int64_t entries = 0;
  std::int64_t written_bytes = 0;
  std::int64_t writes = 0;
  std::int64_t local_misses = 0;
  std::int64_t invalidations = 0;

  [[nodiscard]] std::int64_t all_splits() const { return start_up_splits + splits; }

  static constexpr auto counters() {
    using C = sim::Counter<BuildCounts>;
    return std::array{
        C{"start_up_splits", "1", "branches split before the frame", &BuildCounts::start_up_splits},
        C{"splits", "1", "branches split during the frame", &BuildCounts::splits},
        C{"locks", "1", "lock transactions", &BuildCounts::locks},
        C{"waits", "1", "lock transactions that found the branch taken", &BuildCounts::waits},
        C{"rereads", "1", "node records read again after a lock that was not won", &BuildCounts::rereads},
        C{"listed", "1", "primitives classified", &BuildCounts::listed},
        C{"overlaps", "1", "overlap tests", &BuildCounts::overlaps},
        C{"children", "1", "children made", &BuildCounts::children},
        C{"entries", "1", "entries of children's lists written", &BuildCounts::entries},
        C{"written_bytes", "byte", "records and lists written", &BuildCounts::written_bytes},
        C{"writes", "1", "write transactions of records and lists; none to a node's own memory",
          &BuildCounts::writes},
        C{"local_misses", "1", "misses that the node's own memory served", &BuildCounts::local_misses},
        C{"invalidations", "1", "lines taken out of other nodes' caches", &BuildCounts::invalidations}};
  }
};
static_assert(sim::declares_every_member<BuildCounts>());

/// Calls visit(cost of one, number) for each part of the work. `costs` is BuildTicks or BuildCycles.
template <class Costs, class Visit>
void for_each_build_part(const Costs& costs, const BuildCounts& counts, Visit&& visit) {
  visit(costs.lock, counts.locks);
  visit(costs.listed, counts.listed);
  visit(costs.overlap, counts.overlaps);
  visit(costs.child, counts.children);
  visit(costs.entry, counts.entries);
  visit(costs.publish, counts.all_splits());
}

/// One level of all trees together, at the end of the frame. With private trees, nodes of the initial tree
/// count once for each database; its P nodes and all nodes below count once for each processor node.
struct BuildLevel {
  std::int64_t branches = 0;  ///< B nodes
  std::int64_t leaves = 0;    ///< L nodes, empty ones included
  std::int64_t partial = 0;   ///< P nodes that were never split
  std::int64_t start_up_splits = 0;
  std::int64_t splits = 0;
  std::int64_t made = 0;             ///< nodes made by splitting their parents, before or during the frame
  std::int64_t made_entries = 0;     ///< entries of the lists they were made with
  std::int64_t distinct_splits = 0;  ///< different branches among the splits of the frame, by database
  std::int64_t visits = 0;           ///< visits of rays in the log to nodes of this level
  std::int64_t node_bytes = 0;       ///< of records
  std::int64_t list_bytes = 0;       ///< of the lists of L and P nodes
  std::int64_t released_bytes = 0;   ///< of lists no longer needed after a split

  static constexpr auto counters() {
    using C = sim::Counter<BuildLevel>;
    return std::array{
        C{"branches", "1", "B nodes at the end", &BuildLevel::branches},
        C{"leaves", "1", "L nodes at the end", &BuildLevel::leaves},
        C{"partial", "1", "P nodes left", &BuildLevel::partial},
        C{"start_up_splits", "1", "branches split before the frame", &BuildLevel::start_up_splits},
        C{"splits", "1", "branches split during the frame", &BuildLevel::splits},
        C{"made", "1", "nodes made by splitting their parents", &BuildLevel::made},
        C{"made_entries", "1", "entries of the lists they were made with", &BuildLevel::made_entries},
        C{"distinct_splits", "1", "different branches among them", &BuildLevel::distinct_splits},
        C{"visits", "1", "visits of rays to nodes", &BuildLevel::visits, sim::MergeRule::sum,
          sim::Better::neither},
        C{"node_bytes", "byte", "bytes of node records", &BuildLevel::node_bytes},
        C{"list_bytes", "byte", "bytes of the lists of L and P nodes", &BuildLevel::list_bytes},
        C{"released_bytes", "byte", "bytes of lists no longer needed", &BuildLevel::released_bytes}};
  }
};
static_assert(sim::declares_every_member<BuildLevel>());

struct BuildResult {
  machine::Sharing sharing = machine::Sharing::given;
  sim::Ticks start_up = 0;         ///< when the initial trees are built and the host starts; within the frame
  sim::Sum start_up_wait = 0;      ///< sum over all nodes of their waits for it; part of their dispatch_wait
  std::int64_t databases = 0;      ///< copies of the initial tree
  std::int64_t trees = 0;          ///< copies of the tree below the initial one
  std::vector<BuildLevel> levels;  ///< levels[i] is level i + 1; empty when the tree is given
  std::vector<BuildCounts> nodes;  ///< one a processor node; empty when the tree is given
  /// For each tree node: 1 for a branch whose children exist in every copy of the tree at the end, else 0;
  /// the next frame can begin with these. Empty unless ReplayOptions::report_built asks for it.
  std::vector<std::uint8_t> built{};

  [[nodiscard]] BuildCounts counts() const;
  [[nodiscard]] BuildLevel all_levels() const;
  /// Splits of branches that another private tree of the same database has split too.
  [[nodiscard]] std::int64_t wasted_splits() const;
};

}  // namespace marti::processors::node
