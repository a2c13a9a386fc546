#include "processors/walk/build_start.h"

#include <algorithm>
#include <string>

#include "sim/key_error.h"

namespace marti::processors::walk {

namespace {

void refuse_without_work(const accel::Topology& topology) {
  if (topology.work.size() != topology.nodes.size()) {
    throw sim::KeyError("build.sharing",
                        "only an octree or a bsp tree is built by splitting nodes; with structure.kind = "
                        "\"grid\", \"bvh\" or \"none\" it must be \"given\"");
  }
}

}  // namespace

std::uint32_t initial_level(const accel::Topology& topology, const machine::BuildConfig& config) {
  std::uint32_t deepest = 0;
  for (const accel::TopologyNode& node : topology.nodes) {
    deepest = std::max<std::uint32_t>(deepest, node.level);
  }
  const std::uint32_t all = deepest + 1;
  if (config.sharing == machine::Sharing::given || config.sharing == machine::Sharing::none) {
    return all;
  }
  switch (config.initial) {
    case machine::InitialTree::full:
      return all;
    case machine::InitialTree::level:
      if (config.level == 0) {
        throw sim::KeyError("build.initial_level", "the root is level 1");
      }
      return std::min(config.level, all);
    case machine::InitialTree::rule:
      break;
  }
  if (!(config.rule_k >= 0.0)) {
    throw sim::KeyError("build.rule_k", "must not be negative");
  }
  std::vector<std::uint64_t> leaves(all + 1);
  std::vector<std::uint64_t> others(all + 1);
  for (const accel::TopologyNode& node : topology.nodes) {
    ++(node.leaf ? leaves : others)[node.level];
  }
  for (std::uint32_t level = 1; level <= deepest; ++level) {
    if (static_cast<double>(leaves[level]) > config.rule_k * static_cast<double>(others[level])) {
      return level;
    }
  }
  return all;
}

std::vector<BranchStart> branch_starts(const accel::Topology& topology, const machine::BuildConfig& config) {
  std::vector<BranchStart> starts(topology.nodes.size(), BranchStart::kept);
  if (config.sharing == machine::Sharing::given) {
    return starts;
  }
  refuse_without_work(topology);
  const std::uint32_t level = initial_level(topology, config);
  for (std::size_t node = 0; node < starts.size(); ++node) {
    if (!topology.nodes[node].leaf) {
      starts[node] = topology.nodes[node].level < level ? BranchStart::eager : BranchStart::lazy;
    }
  }
  return starts;
}

void check_starts(const accel::Topology& topology, const std::vector<BranchStart>& starts) {
  if (starts.size() != topology.nodes.size()) {
    throw sim::UserError("the start states are of " + std::to_string(starts.size()) +
                         " nodes, but the tree has " + std::to_string(topology.nodes.size()));
  }
  for (std::size_t node = 0; node < starts.size(); ++node) {
    const accel::TopologyNode& branch = topology.nodes[node];
    if (branch.leaf || starts[node] == BranchStart::kept) {
      continue;
    }
    refuse_without_work(topology);
    if (starts[node] != BranchStart::lazy) {
      continue;
    }
    for (std::uint32_t child = branch.first; child < branch.first + branch.count; ++child) {
      if (!topology.nodes[child].leaf && starts[child] != BranchStart::lazy) {
        throw sim::UserError("the start state of node " + std::to_string(child) +
                             " says that it is split, but its parent is not");
      }
    }
  }
}

}  // namespace marti::processors::walk
