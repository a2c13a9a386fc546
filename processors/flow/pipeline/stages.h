// The stages of the pipeline, after LINKS-1, and the stage that takes each step.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "accel/topology.h"
#include "processors/machine/flow_config.h"
#include "processors/program/work_log.h"

namespace marti::processors::flow {

/// search walks the structure to the next leaf with objects, nearest tests them, shade does material and
/// lights.
enum class Stage : std::uint8_t { search, nearest, shade };
inline constexpr std::array<std::string_view, machine::pipeline_stages> stage_names = {"search", "nearest",
                                                                                       "shade"};

/// The stage of the node with that number in its cluster.
[[nodiscard]] constexpr Stage stage_of_node(const machine::PipelineConfig& pipeline, std::uint32_t number) {
  return number < pipeline.search                      ? Stage::search
         : number < pipeline.search + pipeline.nearest ? Stage::nearest
                                                       : Stage::shade;
}

/// How many entries of a leaf's list the visit at `word` (a leaf, partial_leaf or mailed_leaf) reads.
[[nodiscard]] inline std::uint32_t entries_read(const std::uint32_t* word, const accel::Topology& topology) {
  return program::step_of(*word) == program::Step::leaf ? topology.nodes[program::operand_of(*word)].count
                                                        : word[1];
}

/// The stage that takes the step at `word`; for a leaf the stage that reads its record. The objects of a leaf
/// with entries belong to `nearest`.
[[nodiscard]] constexpr Stage stage_of(const std::uint32_t* word) {
  switch (program::step_of(*word)) {
    case program::Step::shade:
    case program::Step::texel:
    case program::Step::any_hit:
    case program::Step::light:
      return Stage::shade;
    default:
      return Stage::search;
  }
}

/// Whether the step at `word` visits a leaf, wholly or in part.
[[nodiscard]] constexpr bool visits_leaf(const std::uint32_t* word) {
  const program::Step step = program::step_of(*word);
  return step == program::Step::leaf || step == program::Step::partial_leaf ||
         step == program::Step::mailed_leaf;
}

}  // namespace marti::processors::flow
