#include "processors/simt/lane_walk.h"

#include "processors/walk/node_order.h"

namespace marti::processors::simt {

LaneWalk::LaneWalk(const walk::ReplayInput& input)
    : input_(input),
      topology_(input.log.topology.nodes.data()),
      entries_(input.log.topology.entries.data()),
      rank_(input.node_rank.empty() ? nullptr : input.node_rank.data()),
      node_bytes_(input.layout.record_bytes(memory::RecordKind::node)),
      transform_bytes_(input.layout.record_bytes(memory::RecordKind::transform)),
      entry_bytes_(input.layout.record_bytes(memory::RecordKind::list)),
      lists_(input.config.layout.leaf == memory::LeafLayout::list),
      written_(input.config.pixels == machine::Pixels::written) {}

void LaneWalk::begin_pixel(Lane& lane, std::uint32_t x, std::uint32_t y) const {
  const std::span<const std::uint32_t> words = input_.log.pixel(x, y);
  lane = {};
  lane.word = words.data();
  lane.word_end = words.data() + words.size();
  if (input_.config.rt.share != machine::RtShare::none) {
    lane.meets = input_.log.meets(x, y).data();
  }
}

bool LaneWalk::node_record(Lane& lane, std::uint32_t node, Test test) const {
  lane.origin.level = topology_[node].level;
  const std::uint32_t record = rank_ == nullptr ? node : rank_[node];
  if (record == walk::no_record) {
    return false;
  }
  const auto kind = memory::RecordKind::node;
  lane.record = {input_.layout.address(kind, record), node_bytes_, kind, test};
  return true;
}

void LaneWalk::transform_record(Lane& lane, std::uint32_t node, Test test) const {
  lane.origin.level = topology_[node].level;
  const auto kind = memory::RecordKind::transform;
  lane.record = {input_.layout.address(kind, rank_[node]), transform_bytes_, kind, test};
}

Record LaneWalk::first_record(std::uint32_t node) const {
  Lane lane;
  if (topology_[node].instance) {
    transform_record(lane, node, Test::none);
  } else if (!node_record(lane, node, Test::none)) {
    const std::uint32_t first = topology_[node].first;
    const auto kind = lists_ ? memory::RecordKind::list : memory::RecordKind::primitive;
    lane.record = {input_.layout.address(kind, first),
                   lists_ ? std::uint64_t{topology_[node].count} * entry_bytes_
                          : input_.layout.record_bytes(kind, first),
                   kind, Test::none};
  }
  return lane.record;
}

bool LaneWalk::visit_leaf(Lane& lane, std::uint32_t node, std::uint32_t tests,
                          cost::StepCounts& steps) const {
  ++steps.leaves;
  lane.entry = entries_ + topology_[node].first;
  lane.entry_end = lane.entry + tests;
  lane.list = lists_ ? tests : 0;
  steps.lists += lane.list != 0 ? 1 : 0;
  return node_record(lane, node, Test::leaf);
}

bool LaneWalk::next_of_leaf(Lane& lane, cost::StepCounts& steps) const {
  if (lane.list != 0) {
    const auto kind = memory::RecordKind::list;
    const auto first = static_cast<std::uint64_t>(lane.entry - entries_);
    lane.record = {input_.layout.address(kind, first), std::uint64_t{lane.list} * entry_bytes_, kind,
                   Test::none};
    lane.list = 0;
    return true;
  }
  if (lane.entry == lane.entry_end) {
    return false;
  }
  const auto kind = memory::RecordKind::primitive;
  const auto place = static_cast<std::uint64_t>(lane.entry - entries_);
  const std::uint32_t primitive = *lane.entry++;
  const accel::PrimitiveKind shape = input_.log.kind_of(primitive);
  ++steps.tests;
  steps.sphere_tests += shape == accel::PrimitiveKind::sphere ? 1 : 0;
  steps.cone_tests += shape == accel::PrimitiveKind::cone ? 1 : 0;
  const std::uint64_t record = lists_ ? primitive : place;
  lane.record = {input_.layout.address(kind, record), input_.layout.record_bytes(kind, record), kind,
                 shape == accel::PrimitiveKind::triangle ? Test::triangle : Test::quadric};
  return true;
}

void LaneWalk::pass_over_visits(Lane& lane) {
  while (lane.word != lane.word_end && program::visits_node(program::step_of(*lane.word))) {
    lane.word += program::step_words(lane.word);
  }
}

bool LaneWalk::next_record(Lane& lane, cost::StepCounts& steps) const {
  for (;;) {
    if (next_of_leaf(lane, steps)) {
      return true;
    }
    if (lane.word == lane.word_end) {
      return false;
    }
    const std::uint32_t operand = program::operand_of(*lane.word);
    switch (program::step_of(*lane.word)) {
      case program::Step::branch:
        ++lane.word;
        if (visit_branch(lane, operand, steps)) {
          return true;
        }
        break;
      case program::Step::transform:
        ++lane.word;
        ++steps.transforms;
        transform_record(lane, operand, Test::transform);
        return true;
      case program::Step::cut:
        ++lane.word;
        ++steps.cuts;
        if (node_record(lane, operand, Test::box)) {
          return true;
        }
        break;
      case program::Step::pass: {
        ++lane.word;
        ++steps.passes;
        const auto kind = memory::RecordKind::material;
        lane.record = {input_.layout.address(kind, operand), input_.layout.record_bytes(kind), kind,
                       Test::leaf};
        lane.origin.level = 0;
        return true;
      }
      case program::Step::leaf:
      case program::Step::partial_leaf: {
        const bool whole = program::whole_visit(*lane.word);
        const std::uint32_t entries = whole ? topology_[operand].count : lane.word[1];
        lane.word += whole ? 1 : 2;
        if (visit_leaf(lane, operand, entries, steps)) {
          return true;
        }
        break;
      }
      default:
        return false;
    }
  }
}

void LaneWalk::add(const ShaderCounts& counts, cost::StepCounts& steps) {
  for (std::size_t kind = 0; kind < program::ray_kinds; ++kind) {
    steps.*cost::ray_counters[kind] += counts[kind];
  }
  const auto of = [&](ShaderStep step) { return counts[static_cast<std::size_t>(step)]; };
  steps.shades += of(ShaderStep::shade);
  steps.lights += of(ShaderStep::light);
  steps.texels += of(ShaderStep::texel);
  steps.any_hits += of(ShaderStep::any_hit);
  steps.pixels += of(ShaderStep::pixel);
}

}  // namespace marti::processors::simt
