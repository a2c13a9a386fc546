#include "studies/paper/level_counts.h"

#include <limits>

#include "sim/error.h"

namespace marti::studies::paper {

namespace {

LevelCount& level_of(std::vector<LevelCount>& levels, const accel::TopologyNode& node) {
  if (levels.size() < node.level) {
    levels.resize(node.level);
  }
  return levels[node.level - 1U];
}

template <class Count>
Count& grown(std::vector<Count>& counts, std::size_t level) {
  if (counts.size() < level) {
    counts.resize(level);
  }
  return counts[level - 1];
}

}  // namespace

std::optional<double> LevelCount::leaf_ratio() const {
  if (nodes() == 0) {
    return std::nullopt;
  }
  const std::uint64_t others = branches + partial;
  return others == 0 ? std::numeric_limits<double>::infinity()
                     : static_cast<double>(leaves) / static_cast<double>(others);
}

std::vector<LevelCount> count_levels(const accel::Topology& topology) {
  std::vector<LevelCount> levels;
  for (const accel::TopologyNode& node : topology.nodes) {
    LevelCount& level = level_of(levels, node);
    if (node.leaf) {
      ++level.leaves;
      level.leaf_entries += node.count;
    } else {
      ++level.branches;
    }
  }
  return levels;
}

std::vector<LevelCount> count_lazy_levels(const accel::Topology& topology,
                                          std::span<const std::uint8_t> touched,
                                          std::uint32_t initial_level) {
  sim::ensure(touched.size() == topology.nodes.size() && topology.work.size() == topology.nodes.size(),
              "a lazily built tree needs a flag and the work of each node");
  std::vector<LevelCount> levels;
  std::vector<std::uint8_t> exists(topology.nodes.size(), 0);
  if (!exists.empty()) {
    exists[0] = 1;
  }
  // Breadth-first order: a node's parent comes before it.
  for (std::size_t number = 0; number < topology.nodes.size(); ++number) {
    if (exists[number] == 0) {
      continue;
    }
    const accel::TopologyNode& node = topology.nodes[number];
    LevelCount& level = level_of(levels, node);
    if (node.leaf) {
      ++level.leaves;
      level.leaf_entries += node.count;
    } else if (node.level < initial_level || touched[number] != 0) {
      ++level.branches;
      for (std::uint32_t child = 0; child < node.count; ++child) {
        exists[std::size_t{node.first} + child] = 1;
      }
    } else {
      ++level.partial;
      level.partial_entries += topology.work[number].listed;
    }
  }
  return levels;
}

std::optional<std::uint32_t> rule_level(std::span<const LevelCount> levels, double k) {
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelCount& level = levels[i];
    if (static_cast<double>(level.leaves) > k * static_cast<double>(level.branches + level.partial)) {
      return static_cast<std::uint32_t>(i + 1);
    }
  }
  return std::nullopt;
}

NodeVisits count_visits(const processors::program::WorkLog& log) {
  using processors::program::Step;
  const std::vector<accel::TopologyNode>& nodes = log.topology.nodes;
  NodeVisits visits;
  visits.touched.assign(nodes.size(), 0);
  for (const processors::program::LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size();
         at += processors::program::step_words(row.words.data() + at)) {
      const std::uint32_t* const word = row.words.data() + at;
      const Step step = processors::program::step_of(*word);
      const std::uint32_t operand = processors::program::operand_of(*word);
      if (step != Step::branch && step != Step::leaf && step != Step::partial_leaf &&
          step != Step::mailed_leaf) {
        continue;
      }
      const accel::TopologyNode& node = nodes[operand];
      ++grown(visits.per_level, node.level);
      if (step == Step::leaf) {
        grown(visits.tests, node.level) += node.count;
      } else if (step == Step::partial_leaf) {
        grown(visits.tests, node.level) += word[1];
      } else if (step == Step::mailed_leaf) {
        grown(visits.tests, node.level) += processors::program::tests_of_mask(word + 2, word[1]);
      }
      visits.touched[operand] = 1;
    }
  }
  for (std::size_t number = 0; number < nodes.size(); ++number) {
    // Levels without a visit are counted too, so that all lists reach to the deepest level.
    grown(visits.per_level, nodes[number].level) += 0;
    grown(visits.tests, nodes[number].level) += 0;
    grown(visits.distinct, nodes[number].level) += visits.touched[number];
  }
  return visits;
}

std::uint64_t bytes_of(const LevelCount& level, const memory::LayoutConfig& layout) {
  const std::uint64_t alignment = layout.record_alignment;
  const std::uint64_t node = (layout.node_bytes + alignment - 1) / alignment * alignment;
  return level.nodes() * node + (level.leaf_entries + level.partial_entries) * layout.entry_bytes;
}

std::uint64_t bytes_of(std::span<const LevelCount> levels, const memory::LayoutConfig& layout) {
  std::uint64_t bytes = 0;
  for (const LevelCount& level : levels) {
    bytes += bytes_of(level, layout);
  }
  return bytes;
}

}  // namespace marti::studies::paper
