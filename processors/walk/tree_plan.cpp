#include "processors/walk/tree_plan.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "processors/walk/node_order.h"
#include "sim/error.h"
#include "sim/round_up.h"

namespace marti::processors::walk {

TreePlan::TreePlan(const accel::Topology& topology, std::vector<BranchStart> starts,
                   const machine::MachineConfig& config)
    : topology_(topology),
      starts_(std::move(starts)),
      places_(topology.nodes.size()),
      written_(topology.nodes.size()),
      section_alignment_(config.layout.section_alignment),
      record_alignment_(config.layout.record_alignment) {
  stride_ = config.layout.node_stride();
  for (std::uint32_t node = 0; node < places_.size(); ++node) {
    const accel::TopologyNode& branch = topology_.nodes[node];
    if (branch.leaf) {
      continue;
    }
    if (starts_[node] == BranchStart::eager) {
      eager_.push_back(node);
    }
    if (starts_[node] == BranchStart::lazy) {
      const bool own_record =
          config.build.sharing == machine::Sharing::private_trees && places_[node].home == none;
      places_[node].lazy = static_cast<std::uint32_t>(lazy_.size());
      lazy_.push_back({node, own_record ? slots_++ : none, 0});
    }
    for (std::uint32_t child = 0; child < branch.count; ++child) {
      written_[branch.first + child] = starts_[node] != BranchStart::kept;
      places_[branch.first + child].home = places_[node].lazy;
      places_[branch.first + child].record = child;
    }
  }
  number_records(config);
  place_lists(config);
}

std::uint32_t TreePlan::listed(std::uint32_t node) const {
  return topology_.nodes[node].leaf ? topology_.nodes[node].count : topology_.work[node].listed;
}

// Initial nodes keep the order that they have in the whole tree.
void TreePlan::number_records(const machine::MachineConfig& config) {
  std::vector<std::uint32_t> order(places_.size());
  std::iota(order.begin(), order.end(), 0U);
  const std::vector<std::uint32_t> rank = node_rank(topology_, true, config.layout);
  for (std::uint32_t node = 0; node < rank.size(); ++node) {
    order[rank[node]] = node;
  }
  for (const std::uint32_t node : order) {
    if (places_[node].home == none) {
      places_[node].record = static_cast<std::uint32_t>(initial_nodes_++);
    }
  }
}

void TreePlan::place_lists(const machine::MachineConfig& config) {
  const std::uint64_t entry_bytes = config.layout.entry_bytes;
  for (std::uint32_t node = 0; node < places_.size(); ++node) {
    Place& place = places_[node];
    if (place.home != none) {
      LazyBranch& home = lazy_[place.home];
      if (place.record == 0) {
        home.block_bytes = topology_.nodes[home.node].count * stride_;
      }
      place.list = home.block_bytes;
      home.block_bytes += listed(node) * entry_bytes;
    } else if (topology_.nodes[node].leaf || starts_[node] == BranchStart::lazy) {
      place.list = initial_entries_;
      initial_entries_ += listed(node);
    } else if (starts_[node] == BranchStart::eager) {
      place.list = eager_list_bytes_;
      eager_list_bytes_ += listed(node) * entry_bytes;
    }
  }
  for (LazyBranch& branch : lazy_) {
    branch.block_bytes = sim::round_up(branch.block_bytes, config.layout.record_alignment);
    all_block_bytes_ += branch.block_bytes;
  }
}

void TreePlan::place_behind(const memory::Layout& layout, std::uint32_t line_bytes) {
  const std::uint64_t alignment = std::max<std::uint64_t>(section_alignment_, line_bytes);
  dynamic_base_ = sim::round_up(layout.end(), alignment);
  lower_base_ =
      sim::round_up(dynamic_base_ + eager_list_bytes_, std::max<std::uint64_t>(alignment, record_alignment_));
  end_ = first_block() + all_block_bytes_;
}

VisitPlan plan_initial_visits(const TreePlan& plan, const program::WorkLog& log, const memory::Layout& layout,
                              unsigned line_shift, const cost::StepTicks& ticks) {
  // The log's topology, with its lists where the plan puts them.
  const accel::Topology& topology = log.topology;
  program::WorkLog placed_log;
  placed_log.primitives = log.primitives;
  placed_log.quadrics = log.quadrics;
  accel::Topology& placed = placed_log.topology;
  placed.nodes = topology.nodes;
  placed.entries.resize(plan.initial_entries());
  std::vector<std::uint32_t> records(topology.nodes.size());
  const auto planned = [&](std::uint32_t node) {
    return plan.place(node).home == TreePlan::none && plan.place(node).lazy == TreePlan::none;
  };
  for (std::uint32_t number = 0; number < records.size(); ++number) {
    accel::TopologyNode& node = placed.nodes[number];
    records[number] = plan.place(number).record;
    if (!planned(number)) {
      node.leaf = true;
      node.count = 0;
    } else if (node.leaf) {
      const auto first = topology.entries.begin() + node.first;
      node.first = static_cast<std::uint32_t>(plan.place(number).list);
      std::copy(first, first + node.count, placed.entries.begin() + node.first);
    }
  }
  VisitPlan visits = plan_visits(placed_log, layout, records, line_shift, ticks);
  for (std::uint32_t number = 0; number < visits.visits.size(); ++number) {
    if (!planned(number)) {
      visits.visits[number].lines = 0;
    }
  }
  return visits;
}

}  // namespace marti::processors::walk
