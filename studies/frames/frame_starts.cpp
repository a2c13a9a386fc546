#include "studies/frames/frame_starts.h"

#include "sim/error.h"

namespace marti::studies::frames {

using processors::walk::BranchStart;

std::vector<BranchStart> partial_starts(const accel::OctreeUpdate& update) {
  const auto& nodes = update.build.topology.nodes;
  std::vector<BranchStart> starts(nodes.size(), BranchStart::kept);
  for (std::uint32_t node = 0; node < nodes.size(); ++node) {
    if (!nodes[node].leaf && update.altered(node)) {
      starts[node] = BranchStart::eager;
    }
  }
  return starts;
}

std::vector<BranchStart> carried_starts(const accel::OctreeUpdate& update,
                                        std::span<const std::uint8_t> built) {
  const auto& nodes = update.build.topology.nodes;
  std::vector<BranchStart> starts(nodes.size(), BranchStart::kept);
  // Whether the node, or one below it, is a kept branch. Children have higher numbers than their parents.
  std::vector<std::uint8_t> holds(nodes.size());
  for (std::size_t left = nodes.size(); left-- > 0;) {
    const auto node = static_cast<std::uint32_t>(left);
    const accel::TopologyNode& branch = nodes[node];
    if (branch.leaf) {
      continue;
    }
    if (!update.altered(node)) {
      const std::uint32_t was = update.was[node];
      sim::ensure(was < built.size(), "a kept node was one of the old tree");
      holds[node] = built[was];
      starts[node] = built[was] != 0 ? BranchStart::kept : BranchStart::lazy;
      continue;
    }
    for (std::uint32_t child = branch.first; child < branch.first + branch.count; ++child) {
      holds[node] |= holds[child];
    }
    starts[node] = holds[node] != 0 ? BranchStart::eager : BranchStart::lazy;
  }
  return starts;
}

}  // namespace marti::studies::frames
