// One lane's way through its pixel's log: which record it reads next while it traces, and what it does in
// shader code (docs/internals/rt-unit.md, Lanes, packets, phases).
#pragma once

#include <array>
#include <cstdint>

#include "processors/cost/accounting.h"
#include "processors/cost/step_time.h"
#include "processors/program/work_log.h"
#include "processors/walk/attribution.h"
#include "processors/walk/replay_input.h"
#include "sim/error.h"

namespace marti::processors::simt {

/// What follows when a lane has its record; the first is for lists.
enum class Test : std::uint8_t { none, box, transform, leaf, triangle, quadric };
inline constexpr std::size_t tests = 6;

/// A record that a lane reads.
struct Record {
  memory::Address at = 0;
  std::uint64_t bytes = 0;
  memory::RecordKind kind = memory::RecordKind::node;
  Test test = Test::none;
};

struct Lane {
  Record record;  ///< that it wants or has
  const std::uint32_t* word = nullptr;
  const std::uint32_t* word_end = nullptr;
  const std::uint32_t* entry = nullptr;  ///< next primitive of the leaf that it visits
  const std::uint32_t* entry_end = nullptr;
  std::uint32_t list = 0;  ///< entries of a list that is still to be read
  std::uint32_t ray = 0;   ///< operand of the ray that it holds: orders rays by bounce, then kind
  std::uint32_t rays = 0;  ///< of the pixel, up to and with this one
  bool goes_back = false;  ///< its ray has been traced before, up to hits that it was asked about
  const std::uint32_t* meets = nullptr;  ///< what its next ray meets (accel/bvh_meets.h), where lanes help
  walk::Origin origin{};                 ///< of its records; kept where it is counted
};

/// A shader phase counts these steps, each with a price of its own: the kinds of ray, then the others.
enum class ShaderStep : std::uint8_t { shade = program::ray_kinds, light, texel, any_hit, pixel };
inline constexpr std::size_t shader_steps = program::ray_kinds + 5;
using ShaderCounts = std::array<std::int64_t, shader_steps>;

class LaneWalk {
 public:
  explicit LaneWalk(const walk::ReplayInput& input);

  /// Puts the lane before the first step of a pixel.
  void begin_pixel(Lane& lane, std::uint32_t x, std::uint32_t y) const;

  /// Takes the lane's visits up to and with its next record, which is then lane.record; counts their steps.
  /// False when the ray has no further record.
  bool next_record(Lane& lane, cost::StepCounts& steps) const;

  /// Where a timed walk decides itself what the lane visits: passes over the visits of its ray in the log.
  static void pass_over_visits(Lane& lane);
  /// The lane visits a branch. True if that has a record, which is then lane.record.
  bool visit_branch(Lane& lane, std::uint32_t node, cost::StepCounts& steps) const {
    ++steps.branches;
    return node_record(lane, node, Test::box);
  }
  /// It visits a leaf and is to test so many of its primitives; as above. The list and the primitives are the
  /// records that follow.
  bool visit_leaf(Lane& lane, std::uint32_t node, std::uint32_t tests, cost::StepCounts& steps) const;
  /// The next of the leaf's list and its primitives, as next_record().
  bool next_of_leaf(Lane& lane, cost::StepCounts& steps) const;
  /// The lane tests no further primitive of its leaf.
  static void end_leaf(Lane& lane) {
    lane.entry = lane.entry_end;
    lane.list = 0;
  }

  /// The first record that a visit to a node reads which tests all that the node lists.
  [[nodiscard]] Record first_record(std::uint32_t node) const;

  /// Whether the lane's ray waits for an answer whether hits of it count.
  [[nodiscard]] static bool waits_for_answer(const Lane& lane) {
    return lane.word != lane.word_end && program::step_of(*lane.word) == program::Step::any_hit;
  }
  /// Takes the lane's shader steps up to and with its next ray, up to the answer whether hits of its ray
  /// count, with which that goes on, or to the pixel's end; counts them in
  /// `counts` and calls read(kind, record address, bytes) for each material and texel. True when the lane
  /// holds a ray now.
  template <class Read>
  bool shade(Lane& lane, ShaderCounts& counts, const Read& read) const;

  /// Adds a lane's shader steps to its node's.
  static void add(const ShaderCounts& counts, cost::StepCounts& steps);

 private:
  bool node_record(Lane& lane, std::uint32_t node, Test test) const;
  void transform_record(Lane& lane, std::uint32_t instance, Test test) const;

  const walk::ReplayInput& input_;
  const accel::TopologyNode* topology_;
  const std::uint32_t* entries_;
  const std::uint32_t* rank_;  // null: records lie in the order of node numbers
  std::uint32_t node_bytes_;
  std::uint32_t transform_bytes_;
  std::uint32_t entry_bytes_;
  bool lists_;    // leaves have lists; else their primitives lie in a row
  bool written_;  // pixels are
};

template <class Read>
bool LaneWalk::shade(Lane& lane, ShaderCounts& counts, const Read& read) const {
  const auto count = [&](ShaderStep step) { ++counts[static_cast<std::size_t>(step)]; };
  const auto material = memory::RecordKind::material;
  const auto read_material = [&](std::uint32_t number) {
    lane.origin.level = 0;
    read(material, input_.layout.address(material, number), input_.layout.record_bytes(material));
  };
  const auto take_texel = [&](std::uint32_t texture) {
    const auto texel = memory::RecordKind::texel;
    count(ShaderStep::texel);
    lane.origin.level = 0;
    read(texel, input_.layout.address(texel, input_.log.texture_begin[texture] + *lane.word++),
         input_.layout.record_bytes(texel));
  };
  while (lane.word != lane.word_end) {
    const std::uint32_t word = *lane.word++;
    const std::uint32_t operand = program::operand_of(word);
    switch (program::step_of(word)) {
      case program::Step::ray:
        ++counts[program::ray_number_of(operand)];
        lane.ray = operand;
        ++lane.rays;
        lane.goes_back = false;
        lane.origin.begin_ray(operand);
        return true;
      case program::Step::shade:
        count(ShaderStep::shade);
        read_material(operand);
        break;
      case program::Step::texel:
        take_texel(operand);
        break;
      case program::Step::any_hit:
        count(ShaderStep::any_hit);
        read_material(operand);
        if (lane.word != lane.word_end && program::step_of(*lane.word) == program::Step::texel) {
          take_texel(program::operand_of(*lane.word++));
        }
        if (!waits_for_answer(lane)) {
          lane.goes_back = true;
          return true;
        }
        break;
      case program::Step::light:
        count(ShaderStep::light);
        break;
      default:
        throw sim::InternalError("a work log with a visit that belongs to no ray");
    }
  }
  if (written_) {
    count(ShaderStep::pixel);
  }
  return false;
}

}  // namespace marti::processors::simt
