#include "processors/flow/space/region_map.h"

#include "sim/error.h"

namespace marti::processors::flow {

namespace {

// The leaves of each part, part by part: those of part p are nodes[begin[p]] to nodes[begin[p + 1] - 1].
struct PartLeaves {
  std::vector<std::uint64_t> begin;
  std::vector<std::uint32_t> nodes;
};

PartLeaves leaves_by_part(const accel::Topology& topology, std::span<const std::uint32_t> part_of,
                          std::uint32_t parts) {
  PartLeaves leaves;
  leaves.begin.assign(std::size_t{parts} + 1, 0);
  const auto each_leaf = [&](auto&& visit) {
    for (std::uint32_t node = 0; node < topology.nodes.size(); ++node) {
      if (topology.nodes[node].leaf && part_of[node] != RegionMap::top) {
        visit(node, part_of[node]);
      }
    }
  };
  each_leaf([&](std::uint32_t /*node*/, std::uint32_t part) { ++leaves.begin[part + 1]; });
  for (std::uint32_t part = 0; part < parts; ++part) {
    leaves.begin[part + 1] += leaves.begin[part];
  }
  leaves.nodes.resize(leaves.begin[parts]);
  std::vector<std::uint64_t> next(leaves.begin.begin(), leaves.begin.end() - 1);
  each_leaf([&](std::uint32_t node, std::uint32_t part) { leaves.nodes[next[part]++] = node; });
  return leaves;
}

void check_tree(const accel::Topology& topology) {
  const std::size_t nodes = topology.nodes.size();
  sim::ensure(nodes > 0, "regions: a tree without nodes");
  std::vector<bool> has_parent(nodes);
  std::size_t children = 0;
  for (std::size_t number = 0; number < nodes; ++number) {
    const accel::TopologyNode& node = topology.nodes[number];
    for (std::uint64_t child = node.first; !node.leaf && child < std::uint64_t{node.first} + node.count;
         ++child) {
      sim::ensure(child > number && child < nodes && !has_parent[child],
                  "regions: a tree in which a node is not the child of one branch before it");
      has_parent[child] = true;
      ++children;
    }
  }
  sim::ensure(children + 1 == nodes, "regions: a tree with nodes that are nobody's children");
}

}  // namespace

RegionMap cut_regions(const accel::Topology& topology, std::uint32_t level) {
  check_tree(topology);
  RegionMap map;
  map.region_of.assign(topology.nodes.size(), RegionMap::top);
  std::vector<std::uint32_t> to_visit = {0};
  while (!to_visit.empty()) {
    const std::uint32_t number = to_visit.back();
    to_visit.pop_back();
    const accel::TopologyNode& node = topology.nodes[number];
    if (node.leaf && node.count == 0) {
      ++map.top_nodes;
      continue;
    }
    if (node.leaf || node.level >= level) {
      map.region_of[number] = map.size();
      map.roots.push_back(number);
      continue;
    }
    ++map.top_nodes;
    for (std::uint32_t child = node.count; child-- > 0;) {
      to_visit.push_back(node.first + child);
    }
  }
  // Children have greater numbers than their parents.
  for (std::uint32_t number = 0; number < topology.nodes.size(); ++number) {
    const accel::TopologyNode& node = topology.nodes[number];
    if (!node.leaf && map.region_of[number] != RegionMap::top) {
      for (std::uint32_t child = 0; child < node.count; ++child) {
        map.region_of[node.first + child] = map.region_of[number];
      }
    }
  }
  return map;
}

void each_distinct_primitive(const accel::Topology& topology, std::span<const std::uint32_t> part_of,
                             std::uint32_t parts, std::uint32_t primitives,
                             const std::function<void(std::uint32_t, std::uint32_t)>& visit) {
  const PartLeaves leaves = leaves_by_part(topology, part_of, parts);
  std::vector<std::uint32_t> seen_by(primitives, RegionMap::top);  // the last part that listed it
  for (std::uint32_t part = 0; part < parts; ++part) {
    for (std::uint64_t i = leaves.begin[part]; i < leaves.begin[part + 1]; ++i) {
      const accel::TopologyNode& leaf = topology.nodes[leaves.nodes[i]];
      for (std::uint32_t entry = 0; entry < leaf.count; ++entry) {
        const std::uint32_t primitive = topology.entries[leaf.first + entry];
        if (seen_by[primitive] != part) {
          seen_by[primitive] = part;
          visit(part, primitive);
        }
      }
    }
  }
}

std::vector<std::uint64_t> distinct_primitives(const accel::Topology& topology,
                                               std::span<const std::uint32_t> part_of, std::uint32_t parts,
                                               std::uint32_t primitives) {
  std::vector<std::uint64_t> distinct(parts, 0);
  each_distinct_primitive(topology, part_of, parts, primitives,
                          [&](std::uint32_t part, std::uint32_t /*primitive*/) { ++distinct[part]; });
  return distinct;
}

}  // namespace marti::processors::flow
