#include "processors/flow/space/region_policy.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>

namespace marti::processors::flow {

std::vector<std::uint32_t> deal_in_blocks(std::uint32_t regions, std::uint32_t parts) {
  std::vector<std::uint32_t> part_of(regions);
  for (std::uint32_t region = 0; region < regions; ++region) {
    part_of[region] = static_cast<std::uint32_t>(std::uint64_t{region} * parts / regions);
  }
  return part_of;
}

std::vector<std::uint32_t> deal_scattered(std::uint32_t regions, std::uint32_t parts) {
  std::vector<std::uint32_t> part_of(regions);
  for (std::uint32_t region = 0; region < regions; ++region) {
    part_of[region] = region % parts;
  }
  return part_of;
}

std::vector<std::uint32_t> deal_balanced(std::span<const std::uint64_t> weights, std::uint32_t parts) {
  const auto regions = static_cast<std::uint32_t>(weights.size());
  std::vector<std::uint32_t> order(regions);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return weights[a] > weights[b]; });

  using Load = std::tuple<std::uint64_t, std::uint32_t, std::uint32_t>;  // weight, regions, part
  std::priority_queue<Load, std::vector<Load>, std::greater<>> least;
  for (std::uint32_t part = 0; part < parts; ++part) {
    least.emplace(0, 0, part);
  }
  std::vector<std::uint32_t> part_of(regions);
  std::uint32_t next = 0;
  const auto deal = [&](std::uint64_t weight) {
    const auto [load, count, part] = least.top();
    least.pop();
    part_of[order[next++]] = part;
    least.emplace(load + weight, count + 1, part);
  };
  while (next < regions && weights[order[next]] > 0) {
    deal(weights[order[next]]);
  }
  // The remaining regions have no weight; dealt by weight, all would go to the same part.
  std::priority_queue<Load, std::vector<Load>, std::greater<>> fewest;
  for (; !least.empty(); least.pop()) {
    const auto [load, count, part] = least.top();
    fewest.emplace(0, count, part);
  }
  least = std::move(fewest);
  while (next < regions) {
    deal(0);
  }
  return part_of;
}

}  // namespace marti::processors::flow
