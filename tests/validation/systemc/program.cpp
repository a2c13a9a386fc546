#include "tests/validation/systemc/program.h"

#include "sim/error.h"

namespace marti::oracle {

using memory::RecordKind;
using processors::cost::Activity;
using processors::program::Step;

namespace {

Operation compute(Activity activity, Time duration) {
  return {Operation::Kind::compute, activity, duration, RecordKind::node, {}};
}
Operation read(RecordKind record, const Extent& extent) {
  return {Operation::Kind::read, Activity::idle, 0, record, extent};
}

}  // namespace

void Program::begin(const Rectangle& packet) {
  packet_ = packet;
  x_ = packet.x0;
  y_ = packet.y0;
  word_ = log_.rows[y_].begin[x_];
}

bool Program::next_step(std::vector<Operation>& operations) {
  operations.clear();
  if (y_ == packet_.y1) {
    return false;
  }
  if (word_ == log_.rows[y_].begin[x_ + 1]) {
    end_pixel(operations);
  } else {
    step(operations);
  }
  return true;
}

void Program::end_pixel(std::vector<Operation>& operations) {
  ++steps_.pixels;
  operations.push_back(compute(Activity::shading, ticks_.pixel));
  operations.push_back(
      {Operation::Kind::write, Activity::idle, 0, RecordKind::pixel, database_.pixel(x_, y_)});
  if (++x_ == packet_.x1) {
    x_ = packet_.x0;
    ++y_;
  }
  if (y_ < packet_.y1) {
    word_ = log_.rows[y_].begin[x_];
  }
}

void Program::step(std::vector<Operation>& operations) {
  const std::uint32_t word = next_word();
  const std::uint32_t operand = processors::program::operand_of(word);
  switch (processors::program::step_of(word)) {
    case Step::branch:
      ++steps_.branches;
      operations.push_back(compute(Activity::traversal, ticks_.branch));
      read_node(operand, operations);
      return;
    case Step::leaf:
      visit_leaf(operand, log_.topology.nodes[operand].count, nullptr, operations);
      return;
    case Step::partial_leaf:
      visit_leaf(operand, next_word(), nullptr, operations);
      return;
    case Step::mailed_leaf: {
      const std::uint32_t entries = next_word();
      const std::uint32_t* const tested = log_.rows[y_].words.data() + word_;
      word_ += (entries + 31) / 32;
      visit_leaf(operand, entries, tested, operations);
      return;
    }
    case Step::ray: {
      std::int64_t* const rays[] = {&steps_.camera_rays, &steps_.shadow_rays, &steps_.reflection_rays,
                                    &steps_.refraction_rays, &steps_.diffuse_rays};
      ++*rays[operand % 8];
      operations.push_back(compute(Activity::traversal, ticks_.ray[operand % 8]));
      return;
    }
    case Step::shade:
      ++steps_.shades;
      operations.push_back(compute(Activity::shading, ticks_.shade));
      operations.push_back(read(RecordKind::material, database_.material(operand)));
      return;
    case Step::light:
      ++steps_.lights;
      operations.push_back(compute(Activity::shading, ticks_.light));
      return;
    case Step::texel:
      ++steps_.texels;
      operations.push_back(compute(Activity::shading, ticks_.texel));
      operations.push_back(read(RecordKind::texel, database_.texel(operand, next_word())));
      return;
    case Step::transform:
      ++steps_.transforms;
      operations.push_back(compute(Activity::traversal, ticks_.transform));
      operations.push_back(read(RecordKind::transform, database_.transform(operand)));
      return;
    case Step::cut:
      ++steps_.cuts;
      operations.push_back(compute(Activity::traversal, ticks_.cut));
      read_node(operand, operations);
      return;
    case Step::any_hit:
      ++steps_.any_hits;
      operations.push_back(compute(Activity::shading, ticks_.any_hit));
      operations.push_back(read(RecordKind::material, database_.material(operand)));
      return;
    case Step::pass:
      ++steps_.passes;
      operations.push_back(compute(Activity::traversal, ticks_.pass));
      operations.push_back(read(RecordKind::material, database_.material(operand)));
      return;
  }
  throw sim::InternalError("the SystemC model knows no such step");
}

void Program::read_node(std::uint32_t number, std::vector<Operation>& operations) {
  if (const Extent record = database_.node(number); record.bytes > 0) {
    operations.push_back(read(RecordKind::node, record));
  }
}

// `tested` has a bit for each entry; without it all are tested.
void Program::visit_leaf(std::uint32_t number, std::uint32_t entries, const std::uint32_t* tested,
                         std::vector<Operation>& operations) {
  const accel::TopologyNode& leaf = log_.topology.nodes[number];
  ++steps_.leaves;
  operations.push_back(compute(Activity::traversal, ticks_.leaf));
  read_node(number, operations);
  if (entries == 0) {
    return;
  }
  ++steps_.lists;
  operations.push_back(read(RecordKind::list, database_.list(leaf, entries)));
  for (std::uint32_t entry = 0; entry < entries; ++entry) {
    if (log_.mailboxes) {
      ++steps_.lookups;
      operations.push_back(compute(Activity::intersection, ticks_.lookup));
    }
    if (tested == nullptr || ((tested[entry / 32] >> (entry % 32)) & 1U) == 1) {
      test(log_.topology.entries[leaf.first + entry], operations);
    }
  }
}

void Program::test(std::uint32_t primitive, std::vector<Operation>& operations) {
  Time duration = ticks_.test;
  ++steps_.tests;
  if (log_.kind_of(primitive) == accel::PrimitiveKind::sphere) {
    ++steps_.sphere_tests;
    duration = ticks_.sphere_test;
  } else if (log_.kind_of(primitive) == accel::PrimitiveKind::cone) {
    ++steps_.cone_tests;
    duration = ticks_.cone_test;
  }
  operations.push_back(compute(Activity::intersection, duration));
  operations.push_back(read(RecordKind::primitive, database_.primitive(primitive)));
}

}  // namespace marti::oracle
