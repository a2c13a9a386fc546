#include "studies/sweep/work/batches.h"

#include <algorithm>
#include <map>
#include <utility>

#include "processors/walk/stripped_log.h"

namespace marti::studies::sweep {

std::vector<MachineBatch> batches_of(const SweepPlan& plan, std::span<const std::size_t> machines) {
  using processors::walk::StrippedLog;
  std::vector<MachineBatch> batches;
  std::map<std::pair<std::size_t, std::string>, std::size_t> known;
  for (const std::size_t number : machines) {
    const SweepMachine& machine = plan.machines[number];
    // What is counted by intervals needs every step in its place.
    const std::string key = machine.interval > 0 ? std::string() : StrippedLog::key_of(machine.config);
    const auto [entry, is_new] = known.try_emplace({machine.frame, key}, batches.size());
    if (is_new) {
      batches.push_back({machine.frame, key, {}, {}});
    }
    MachineBatch& batch = batches[entry->second];
    batch.machines.push_back(number);
    const std::uint32_t ways = StrippedLog::ways_of(machine.config);
    const auto place = std::ranges::lower_bound(batch.ways, ways);
    if (place == batch.ways.end() || *place != ways) {
      batch.ways.insert(place, ways);
    }
  }
  const auto timing = [&](std::size_t machine) { return plan.machines[machine].timing; };
  for (MachineBatch& batch : batches) {
    std::ranges::stable_sort(batch.machines, {}, timing);
  }
  return batches;
}

bool pays_to_strip(const MachineBatch& batch) {
  const bool lru = std::ranges::any_of(batch.ways, [](std::uint32_t ways) { return ways != 0; });
  return !batch.key.empty() && batch.machines.size() >= (lru ? 2U : 4U);
}

}  // namespace marti::studies::sweep
