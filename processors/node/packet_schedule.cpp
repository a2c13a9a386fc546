#include "processors/node/packet_schedule.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace marti::processors::node {

sim::Ticks schedule_packets(const machine::HostConfig& config, std::uint32_t nodes,
                            std::span<const sim::Ticks> packets) {
  Host host(config, packets.size(), nodes);
  using Free = std::pair<sim::Ticks, std::uint32_t>;  // when a node is free, and which node
  std::priority_queue<Free, std::vector<Free>, std::greater<>> free;
  for (std::uint32_t node = 0; node < nodes; ++node) {
    free.emplace(0, node);
  }
  sim::Ticks end = 0;
  while (!free.empty()) {
    const auto [now, node] = free.top();
    free.pop();
    end = std::max(end, now);
    if (const auto grant = host.next(node, now)) {
      free.emplace(sim::add_ticks(grant->start, packets[grant->packet]), node);
    }
  }
  return end;
}

}  // namespace marti::processors::node
