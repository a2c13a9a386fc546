#include "studies/paper/building_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "studies/paper/tree_table.h"

namespace marti::studies {

std::string InitialLevel::note() const {
  std::string text = whole ? "whole tree" : "";
  for (const double k : rules) {
    text += (text.empty() ? "" : ", ") + fmt::format("k = {:g}", k);
  }
  return text;
}

std::vector<InitialLevel> initial_levels(const PaperConfig& config, std::span<const LevelCount> levels) {
  const auto deepest = static_cast<std::uint32_t>(levels.size());
  std::vector<InitialLevel> chosen;
  for (const std::uint32_t level : config.levels) {
    if (level < deepest) {
      chosen.push_back({level, false, {}});
    }
  }
  chosen.push_back({deepest, true, {}});
  for (const double k : config.rules) {
    const std::uint32_t level = rule_level(levels, k).value_or(deepest);
    auto at = std::find_if(chosen.begin(), chosen.end(), [level](const auto& c) { return c.level >= level; });
    if (at->level != level) {
      at = chosen.insert(at, {level, false, {}});
    }
    at->rules.push_back(k);
  }
  return chosen;
}

LevelCount BuiltTree::total() const { return TreeSize{levels, 0, 0.0}.total(); }

std::vector<BuiltTree> built_trees(const PaperConfig& config, const TracedRun& run) {
  std::vector<BuiltTree> trees;
  for (InitialLevel& initial : initial_levels(config, run.levels)) {
    const std::uint32_t level = initial.level;
    trees.push_back({std::move(initial), count_lazy_levels(run.log->topology, run.visits.touched, level)});
  }
  return trees;
}

}  // namespace marti::studies
