#include "processors/node/build_report.h"
#include "processors/walk/law.h"

#include <algorithm>
#include <string>

#include "sim/error.h"

namespace marti::processors::node {

namespace {

void count_visits(const program::WorkLog& log, std::vector<BuildLevel>& levels) {
  for (const program::LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size(); at += program::step_words(row.words.data() + at)) {
      const program::Step step = program::step_of(row.words[at]);
      if (step == program::Step::branch || step == program::Step::leaf ||
          step == program::Step::partial_leaf || step == program::Step::mailed_leaf) {
        ++levels[log.topology.nodes[program::operand_of(row.words[at])].level - 1U].visits;
      }
    }
  }
}

// How many trees have split a lazy branch, and how many databases have at least one such tree.
struct Builders {
  std::int64_t trees = 0;
  std::int64_t databases = 0;
};

Builders builders_of(const TreeCopies& copies, std::uint32_t lazy, std::uint32_t trees_a_database) {
  Builders builders;
  for (std::uint32_t first = 0; first < copies.copies(); first += trees_a_database) {
    const std::int64_t before = builders.trees;
    for (std::uint32_t copy = first; copy < first + trees_a_database; ++copy) {
      builders.trees += copies.built(copy, lazy) ? 1 : 0;
    }
    builders.databases += builders.trees > before ? 1 : 0;
  }
  return builders;
}

// For each tree node: 1 for a branch whose children exist in every copy, else 0.
std::vector<std::uint8_t> built_branches(const accel::Topology& topology, const walk::TreePlan& plan,
                                         const TreeCopies& copies) {
  std::vector<std::uint8_t> built(topology.nodes.size());
  for (std::uint32_t node = 0; node < built.size(); ++node) {
    const std::uint32_t lazy = plan.place(node).lazy;
    bool all = !topology.nodes[node].leaf;
    for (std::uint32_t copy = 0; all && lazy != walk::TreePlan::none && copy < copies.copies(); ++copy) {
      all = copies.built(copy, lazy);
    }
    built[node] = all ? 1 : 0;
  }
  return built;
}

}  // namespace

BuildCounts BuildResult::counts() const {
  BuildCounts sum;
  for (const BuildCounts& node : nodes) {
    sim::merge(sum, node);
  }
  return sum;
}

BuildLevel BuildResult::all_levels() const {
  BuildLevel sum;
  for (const BuildLevel& level : levels) {
    sim::merge(sum, level);
  }
  return sum;
}

std::int64_t BuildResult::wasted_splits() const {
  const BuildLevel sum = all_levels();
  return sum.splits - sum.distinct_splits;
}

BuildResult report_build(const walk::ReplayInput& input, const TreeCopies& copies) {
  const accel::Topology& topology = input.log.topology;
  const walk::TreePlan& plan = *input.tree;
  const machine::MachineConfig& config = input.config;
  BuildResult result;
  result.sharing = config.build.sharing;
  result.databases =
      config.placement == machine::Placement::replicated ? config.all_nodes() : config.clusters;
  result.trees = copies.copies();
  const auto trees_a_database = static_cast<std::uint32_t>(result.trees / config.clusters);
  std::uint32_t deepest = 0;
  for (const accel::TopologyNode& node : topology.nodes) {
    deepest = std::max<std::uint32_t>(deepest, node.level);
  }
  result.levels.resize(deepest);
  count_visits(input.log, result.levels);

  if (input.report_built) {
    result.built = built_branches(topology, plan, copies);
  }
  // The number of trees in which a node exists, by the lazy number of its parent.
  std::vector<std::int64_t> trees_with(plan.lazy().size());
  for (std::uint32_t number = 0; number < topology.nodes.size(); ++number) {
    const accel::TopologyNode& node = topology.nodes[number];
    const walk::TreePlan::Place& place = plan.place(number);
    BuildLevel& level = result.levels[node.level - 1U];
    const bool initial = place.home == walk::TreePlan::none;
    const std::int64_t records = initial ? result.databases : trees_with[place.home];
    const auto record_bytes = static_cast<std::int64_t>(plan.stride());
    const std::int64_t list_bytes = std::int64_t{plan.listed(number)} * config.layout.entry_bytes;
    level.node_bytes += records * record_bytes;
    if (plan.list_is_written(number)) {
      level.made += records;
      level.made_entries += records * plan.listed(number);
    }
    if (node.leaf) {
      level.leaves += records;
      level.list_bytes += records * list_bytes;
    } else if (place.lazy == walk::TreePlan::none) {
      level.branches += records;
      if (plan.start(number) == walk::BranchStart::eager) {
        level.start_up_splits += records;
        level.released_bytes += records * list_bytes;
      }
    } else {
      const Builders builders = builders_of(copies, place.lazy, trees_a_database);
      const std::int64_t there = initial ? result.trees : records;
      trees_with[place.lazy] = builders.trees;
      level.splits += builders.trees;
      level.distinct_splits += builders.databases;
      level.branches += builders.trees;
      level.partial += there - builders.trees;
      const bool own_record = plan.lazy()[place.lazy].slot != walk::TreePlan::none;
      level.node_bytes += own_record ? result.trees * record_bytes : 0;
      // A list that several trees begin with is kept: another processor node may still need it.
      const std::int64_t released = own_record && result.databases < result.trees ? 0 : builders.trees;
      level.released_bytes += released * list_bytes;
      level.list_bytes += (records - released) * list_bytes;
    }
  }
  return result;
}

void add_building_time(const cost::BuildTicks& ticks, const BuildCounts& counts, cost::TimeDivision& time) {
  sim::Ticks& building = time[static_cast<std::size_t>(cost::Activity::building)];
  const auto add = [&](sim::Ticks each, std::int64_t count) {
    building = sim::add_ticks(building, sim::multiply_ticks(each, count));
  };
  for_each_build_part(ticks, counts, add);
}

void check_build(const program::WorkLog& log, const machine::MachineConfig& config,
                 const BuildResult& result) {
  const BuildCounts counts = result.counts();
  const BuildLevel levels = result.all_levels();
  walk::require(levels.splits == counts.splits, "every lazy branch is split at most once in each tree");
  walk::require(levels.start_up_splits == counts.start_up_splits,
                "every database's initial tree is split once before the frame");
  walk::require(counts.written_bytes == (counts.children + counts.all_splits()) * config.layout.node_bytes +
                                            counts.entries * config.layout.entry_bytes,
                "the bytes written are those of the records and lists made");
  walk::require(
      counts.locks - counts.rereads == (result.sharing == machine::Sharing::shared ? counts.splits : 0),
      "a lock is won for each branch split in a shared tree, or its record is read again");
  walk::require(levels.distinct_splits <= levels.splits, "different splits are among all splits");
  walk::require(levels.made == counts.children, "the nodes made are the children of what was split");
  walk::require(levels.made_entries == counts.entries, "the entries written are those of the nodes made");
  const program::LogTotals totals = program::totals_of(log);
  walk::require(levels.visits == static_cast<std::int64_t>(totals.branches + totals.leaves),
                "the visits of the levels are those of the log");
}

}  // namespace marti::processors::node
