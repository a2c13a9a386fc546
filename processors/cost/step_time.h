// A machine's step costs in ticks, and how a node's computing time divides among activities, from counts.
#pragma once

#include "processors/cost/accounting.h"
#include "processors/cost/cost_model.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"

namespace marti::processors::cost {

struct StepTicks {
  std::array<sim::Ticks, program::ray_kinds> ray{};
  sim::Ticks branch = 0;
  sim::Ticks transform = 0;
  sim::Ticks leaf = 0;
  sim::Ticks lookup = 0;  ///< looking up the mailbox of one entry; 0 without mailboxes
  sim::Ticks test = 0;
  sim::Ticks sphere_test = 0;
  sim::Ticks cone_test = 0;
  sim::Ticks shade = 0;
  sim::Ticks light = 0;
  sim::Ticks texel = 0;
  sim::Ticks any_hit = 0;
  sim::Ticks cut = 0;
  sim::Ticks pass = 0;
  sim::Ticks pixel = 0;
  sim::Ticks hit = 0;
  friend bool operator==(const StepTicks&, const StepTicks&) = default;
};

/// The times on this machine of the steps of the traversal that made `log`.
[[nodiscard]] StepTicks step_ticks(const machine::MachineConfig& config, const program::WorkLog& log);

/// The words of each record, as this machine's layout has it.
[[nodiscard]] RecordWords record_words(const machine::MachineConfig& config);

/// Calls visit(activity, cost of one such step, number of steps) for each kind of step. `costs` is StepTicks
/// or StepCycles.
template <class Costs, class Visit>
void for_each_step(const Costs& costs, const StepCounts& steps, Visit&& visit) {
  for (std::size_t kind = 0; kind < program::ray_kinds; ++kind) {
    visit(Activity::traversal, costs.ray[kind], steps.*ray_counters[kind]);
  }
  visit(Activity::traversal, costs.branch, steps.branches);
  visit(Activity::traversal, costs.transform, steps.transforms);
  visit(Activity::traversal, costs.leaf, steps.leaves);
  visit(Activity::traversal, costs.cut, steps.cuts);
  visit(Activity::traversal, costs.pass, steps.passes);
  visit(Activity::intersection, costs.lookup, steps.lookups);
  visit(Activity::intersection, costs.test, steps.tests - steps.sphere_tests - steps.cone_tests);
  visit(Activity::intersection, costs.sphere_test, steps.sphere_tests);
  visit(Activity::intersection, costs.cone_test, steps.cone_tests);
  visit(Activity::shading, costs.shade, steps.shades);
  visit(Activity::shading, costs.light, steps.lights);
  visit(Activity::shading, costs.texel, steps.texels);
  visit(Activity::shading, costs.any_hit, steps.any_hits);
  visit(Activity::shading, costs.pixel, steps.pixels);
}

/// Adds traversal, intersection, shading and cache access of `counts` to `time`.
void add_counted_time(const StepTicks& ticks, const StepCounts& steps, std::int64_t hits, TimeDivision& time);

/// Counts one test of a primitive; returns its time.
[[nodiscard]] inline sim::Ticks count_test(const StepTicks& ticks, accel::PrimitiveKind kind,
                                           StepCounts& steps) {
  ++steps.tests;
  switch (kind) {
    case accel::PrimitiveKind::triangle:
      break;
    case accel::PrimitiveKind::sphere:
      ++steps.sphere_tests;
      return ticks.sphere_test;
    case accel::PrimitiveKind::cone:
      ++steps.cone_tests;
      return ticks.cone_test;
  }
  return ticks.test;
}

}  // namespace marti::processors::cost
