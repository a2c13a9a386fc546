#include "processors/node/tree_copies.h"

#include <bit>
#include <string>

#include "sim/key_error.h"

namespace marti::processors::node {

namespace {

bool have_private_trees(const machine::MachineConfig& config) {
  return config.build.sharing == machine::Sharing::private_trees;
}

std::uint32_t copies_of(const machine::MachineConfig& config) {
  return have_private_trees(config) ? config.all_nodes() : config.clusters;
}

}  // namespace

TreeCopies::Lines TreeCopies::lines_of(const walk::TreePlan& plan, const memory::Layout& layout,
                                       const machine::MachineConfig& config) {
  if (have_private_trees(config) || plan.lazy().empty()) {
    return {};
  }
  const std::uint64_t line = config.reference_bytes();
  const auto lines_below = [&](memory::Address end) {
    return static_cast<std::uint32_t>((end + line - 1) / line);
  };
  Lines lines;
  lines.initial =
      lines_below(layout.base(memory::RecordKind::node) + layout.section_bytes(memory::RecordKind::node));
  lines.lower_begin = static_cast<std::uint32_t>(plan.lower_base() / line);
  lines.all = lines.initial + std::size_t{lines_below(plan.end()) - lines.lower_begin};
  return lines;
}

std::uint64_t TreeCopies::host_bytes(const walk::TreePlan& plan, const memory::Layout& layout,
                                     const machine::MachineConfig& config) {
  return std::uint64_t{copies_of(config)} *
         (plan.lazy().size() * 13 + lines_of(plan, layout, config).all * 5 + 12);
}

TreeCopies::TreeCopies(const walk::TreePlan& plan, const accel::Topology& topology,
                       const memory::Layout& layout, const machine::MachineConfig& config)
    : plan_(plan),
      topology_(topology),
      private_(have_private_trees(config)),
      nodes_(config.nodes),
      copies_(copies_of(config)),
      lazies_(plan.lazy().size()),
      line_shift_(static_cast<unsigned>(std::countr_zero(config.reference_bytes()))),
      node_bytes_(config.layout.node_bytes),
      lines_(lines_of(plan, layout, config)),
      node_section_(layout.base(memory::RecordKind::node)) {
  const std::uint64_t bytes = host_bytes(plan, layout, config);
  if (bytes > most_bytes) {
    throw sim::KeyError("build.sharing",
                        "keeping track of " + std::to_string(copies_) + " trees with " +
                            std::to_string(lazies_) + " branches to build would take " +
                            std::to_string(bytes >> 20U) +
                            " MiB; simulate fewer processor nodes, or raise build.initial_level");
  }
  block_.resize(copies_ * lazies_);
  built_.resize(copies_ * lazies_);
  builder_.resize(private_ ? 0 : copies_ * lazies_);
  next_.assign(copies_, plan.first_block());
  open_.resize(copies_ * lines_.all);
  cached_.resize(copies_ * lines_.all);
  allocated_.assign(copies_, lines_.lower_begin);
  if (lines_.all == 0) {
    return;
  }
  for (const walk::TreePlan::LazyBranch& branch : plan.lazy()) {
    const walk::TreePlan::Place& place = plan.place(branch.node);
    for (std::uint32_t copy = 0; place.home == walk::TreePlan::none && copy < copies_; ++copy) {
      count_open(copy, layout.address(memory::RecordKind::node, place.record), node_bytes_, 1);
    }
  }
}

std::size_t TreeCopies::index_of(std::uint32_t copy, std::uint32_t line) const {
  return copy * lines_.all + (line < lines_.initial ? line : lines_.initial + (line - lines_.lower_begin));
}

void TreeCopies::count_open(std::uint32_t copy, memory::Address begin, std::uint64_t bytes, std::int32_t by) {
  if (lines_.all == 0 || bytes == 0) {
    return;
  }
  const auto last = static_cast<std::uint32_t>((begin + bytes - 1) >> line_shift_);
  for (auto line = static_cast<std::uint32_t>(begin >> line_shift_); line <= last; ++line) {
    open_[index_of(copy, line)] += static_cast<std::uint32_t>(by);
  }
}

void TreeCopies::take(std::uint32_t copy, std::uint32_t lazy, std::uint32_t builder) {
  sim::ensure(!taken(copy, lazy), "a branch is split twice in one tree");
  const walk::TreePlan::LazyBranch& branch = plan_.lazy()[lazy];
  const memory::Address block = next_[copy];
  block_[at(copy, lazy)] = block;
  next_[copy] = block + branch.block_bytes;
  if (private_) {
    return;
  }
  builder_[at(copy, lazy)] = builder;
  allocated_[copy] = static_cast<std::uint32_t>(next_[copy] >> line_shift_);
  // The whole block is open until it is published, a P node's record in it until the P node is published.
  count_open(copy, block, branch.block_bytes, 1);
  const accel::TopologyNode& node = topology_.nodes[branch.node];
  for (std::uint32_t child = 0; child < node.count; ++child) {
    if (!topology_.nodes[node.first + child].leaf) {
      count_open(copy, block + child * plan_.stride(), node_bytes_, 1);
    }
  }
}

void TreeCopies::publish(std::uint32_t copy, std::uint32_t lazy) {
  sim::ensure(taken(copy, lazy) && !built(copy, lazy), "a branch is published that nobody has split");
  built_[at(copy, lazy)] = 1;
  if (private_) {
    return;
  }
  const walk::TreePlan::LazyBranch& branch = plan_.lazy()[lazy];
  count_open(copy, block(copy, lazy), branch.block_bytes, -1);
  const walk::TreePlan::Place& place = plan_.place(branch.node);
  const memory::Address record = place.home == walk::TreePlan::none
                                     ? node_section_ + place.record * plan_.stride()
                                     : block(copy, place.home) + place.record * plan_.stride();
  count_open(copy, record, node_bytes_, -1);
}

LineStates TreeCopies::lines(std::uint32_t copy) const {
  if (lines_.all == 0) {
    return {};
  }
  return {open_.data() + copy * lines_.all, lines_.initial, lines_.lower_begin, &allocated_[copy]};
}

void TreeCopies::note_cached(std::uint32_t copy, std::uint32_t line) {
  if (lines_.all != 0 && !lines(copy).settled(line)) {
    cached_[index_of(copy, line)] = 1;
  }
}

bool TreeCopies::maybe_cached(std::uint32_t copy, std::uint32_t line) const {
  return lines_.all != 0 && (line < lines_.initial || line >= lines_.lower_begin) &&
         cached_[index_of(copy, line)] != 0;
}

}  // namespace marti::processors::node
