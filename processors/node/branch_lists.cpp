#include "processors/node/branch_lists.h"

#include <algorithm>

namespace marti::processors::node {

std::span<const std::uint32_t> BranchLists::of(std::uint32_t branch) {
  const auto [at, is_new] = lists_.try_emplace(branch);
  std::vector<std::uint32_t>& list = at->second;
  if (!is_new) {
    return list;
  }
  std::vector<std::uint32_t> pending = {branch};
  while (!pending.empty()) {
    const accel::TopologyNode& node = topology_.nodes[pending.back()];
    pending.pop_back();
    if (node.leaf) {
      const auto first = topology_.entries.begin() + node.first;
      list.insert(list.end(), first, first + node.count);
      continue;
    }
    for (std::uint32_t child = 0; child < node.count; ++child) {
      pending.push_back(node.first + child);
    }
  }
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  list.shrink_to_fit();
  return list;
}

}  // namespace marti::processors::node
