// From operations to cycles: the compute time of each kind of step at a processor node. References to memory
// are not part of it; the node adds them from the database layout.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "accel/traversal.h"
#include "processors/machine/operation_cycles.h"
#include "processors/program/work_log.h"
#include "sim/schema.h"

namespace marti::processors::cost {

struct OperationMix;

/// Words moved by one record of each kind, from the database layout: record bytes / word bytes, rounded up.
struct RecordWords {
  std::int64_t node = 2;
  std::int64_t entry = 1;
  std::int64_t primitive = 12;
  std::int64_t quadric = 10;
  std::int64_t material = 16;
  std::int64_t texel = 1;
  std::int64_t pixel = 1;
  std::int64_t transform = 16;
};

/// Whole compute cycles of each kind of step.
struct StepCycles {
  std::array<std::int64_t, program::ray_kinds> ray{};  ///< setting up a ray of each RayKind and its traversal
  std::int64_t branch = 0;                             ///< reading a branch and ordering its children
  std::int64_t transform = 0;  ///< reading an instance's transform and bringing the ray into its mesh
  std::int64_t leaf = 0;       ///< reading a leaf, without its tests
  std::int64_t lookup = 0;  ///< with mailboxes, one entry of a leaf's list: fetch its id, look at its mailbox
  std::int64_t test = 0;    ///< one test: fetch the triangle, and its id unless it was looked up, test it,
                            ///< and with mailboxes leave the ray's number in the mailbox
  std::int64_t sphere_test = 0;  ///< a test of a sphere instead
  std::int64_t cone_test = 0;    ///< a test of a cylinder or cone instead
  std::int64_t shade = 0;
  std::int64_t light = 0;
  std::int64_t texel = 0;
  std::int64_t any_hit = 0;  ///< asking whether a hit counts, without the texel that decides
  std::int64_t cut = 0;      ///< reading a node and finding that it is small and enough of it covered
  std::int64_t pass = 0;     ///< reading an averaged material and finding that too little is covered
  std::int64_t pixel = 0;    ///< converting and storing one finished pixel
};

/// Names of the presets: a processor and its year, or `unit`, in which each operation takes a cycle.
[[nodiscard]] std::span<const std::string_view> cost_presets();
/// The default of the configuration.
inline constexpr std::string_view default_cost_preset = "arm1176-2003";
/// Names that presets had before, which are refused.
[[nodiscard]] std::span<const sim::RenamedChoice> renamed_cost_presets();

/// The costs of a named preset. Throws UserError for an unknown name. Each preset's source is in
/// cost_model.cpp.
[[nodiscard]] machine::OperationCycles cost_preset(std::string_view name);

/// The cycles of a mix, rounded to nearest with halves up, plus `fixed` cycles; UserError beyond 64 bits.
[[nodiscard]] std::int64_t price(const OperationMix& mix, const machine::OperationCycles& cycles,
                                 std::int64_t fixed);

/// Cycles to fetch or to store a record of so many words: an integer operation for its address, then the
/// words.
[[nodiscard]] std::int64_t fetch_record(const machine::OperationCycles& cycles, std::int64_t words);
[[nodiscard]] std::int64_t store_record(const machine::OperationCycles& cycles, std::int64_t words);

/// Prices the measured operation mixes of a traversal and a program (operation_mix.h). Rounds each step to
/// whole cycles, halves up. Mailboxes are words of the node's own memory, one for each primitive.
[[nodiscard]] StepCycles step_cycles(const machine::OperationCycles& cycles, const RecordWords& words,
                                     accel::Traversal traversal = accel::Traversal::octree,
                                     bool mailboxes = false,
                                     program::Integrator integrator = program::Integrator::whitted);

}  // namespace marti::processors::cost
