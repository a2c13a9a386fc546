#include "processors/walk/node_order.h"

namespace marti::processors {

std::vector<std::uint32_t> depth_first_rank(const accel::Topology& topology) {
  std::vector<std::uint32_t> rank(topology.nodes.size(), 0);
  if (rank.empty()) {
    return rank;
  }
  std::uint32_t next = 1;  // the root is record 0
  std::vector<std::uint32_t> pending = {0};
  while (!pending.empty()) {
    const std::uint32_t number = pending.back();
    pending.pop_back();
    const accel::TopologyNode& node = topology.nodes[number];
    if (node.leaf) {
      continue;
    }
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      rank[child] = next++;
    }
    for (std::uint32_t child = node.first + node.count; child > node.first; --child) {
      pending.push_back(child - 1);
    }
  }
  return rank;
}

}  // namespace marti::processors
