// What schemes in which rays move between nodes count in addition to the counts of every scheme.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "memory/network.h"
#include "memory/wait_statistics.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::processors::flow {

/// The rays and messages of one node.
struct FlowCounts {
  std::int64_t taken = 0;
  std::int64_t made = 0;
  std::int64_t passed_on = 0;
  std::int64_t ended = 0;
  std::int64_t contributions = 0;
  std::int64_t bytes_sent = 0;
  std::int64_t longest_queue = 0;
  std::int64_t most_set_aside = 0;
  sim::Sum queued = 0;

  static constexpr auto counters() {
    using C = sim::Counter<FlowCounts>;
    using sim::MergeRule;
    return std::array{
        C{"taken", "1", "rays taken from the queue", &FlowCounts::taken, sim::MergeRule::sum,
          sim::Better::neither},
        C{"made", "1", "rays made at points shaded here", &FlowCounts::made, sim::MergeRule::sum,
          sim::Better::neither},
        C{"passed_on", "1", "rays sent to other nodes for their next steps", &FlowCounts::passed_on},
        C{"ended", "1", "rays that ended here", &FlowCounts::ended, sim::MergeRule::sum,
          sim::Better::neither},
        C{"contributions", "1", "contributions to pixels sent to the host", &FlowCounts::contributions,
          sim::MergeRule::sum, sim::Better::neither},
        C{"bytes_sent", "byte", "bytes of the messages sent", &FlowCounts::bytes_sent},
        C{"longest_queue", "1", "most slots of its queue in use at a time", &FlowCounts::longest_queue,
          MergeRule::maximum},
        C{"most_set_aside", "1", "most rays set aside in the node's own memory at a time",
          &FlowCounts::most_set_aside, MergeRule::maximum},
        C{"queued", "ps", "waits of the rays in its queue", &FlowCounts::queued}};
  }
};
static_assert(sim::declares_every_member<FlowCounts>());

/// Empty (no nodes) for the image scheme.
struct FlowResult {
  std::vector<FlowCounts> nodes;                    ///< one for each node
  std::vector<memory::NetworkStatistics> networks;  ///< one for each cluster
  std::vector<std::uint64_t> memory_bytes;          ///< of the database, in each node's own memory
  std::int64_t rays = 0;                            ///< camera rays sent and rays made at nodes
  std::int64_t collected = 0;                       ///< contributions that reached the host
  std::int64_t most_in_flight = 0;                  ///< most rays at a time, of all clusters together
  std::uint64_t regions = 0;                        ///< space: number of regions that the tree is cut into
  std::uint64_t top_nodes = 0;                      ///< space: tree nodes that every node has
  std::uint64_t duplicated_primitives = 0;          ///< space: in a cluster, primitive records beyond one of
                                                    ///< each
  sim::Ticks sampling_work = 0;                     ///< space: compute time of a pre-pass before the frame
};

}  // namespace marti::processors::flow
