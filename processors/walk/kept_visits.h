// The planned visits of one replay, kept for the next one.
#pragma once

#include <memory>

#include "memory/layout.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/visit_plan.h"

namespace marti::processors::walk {

/// For replays of logs of one tree, one after the other, such as those of a machine and of the same machine
/// with one node: most have equal layouts and equal times of steps, and then need plan visits only once.
class KeptVisits {
 public:
  /// The visits of `input`, whose log must be of the tree of all inputs before, and whose tree is given.
  /// Several threads may ask for visits that are kept already: then nothing is written.
  [[nodiscard]] std::shared_ptr<const VisitPlan> of(const ReplayInput& input);

 private:
  std::shared_ptr<const VisitPlan> plan_;  ///< null before the first
  memory::LayoutConfig layout_;            ///< what it was made for, like all below
  std::uint32_t line_bytes_ = 0;
  cost::StepTicks ticks_;
};

}  // namespace marti::processors::walk
