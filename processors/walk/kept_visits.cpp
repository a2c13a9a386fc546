#include "processors/walk/kept_visits.h"

#include <bit>

namespace marti::processors::walk {

std::shared_ptr<const VisitPlan> KeptVisits::of(const ReplayInput& input) {
  const std::uint32_t line_bytes = input.config.reference_bytes();
  const cost::StepTicks ticks = cost::step_ticks(input.config, input.log);
  if (plan_ == nullptr || layout_ != input.config.layout || line_bytes_ != line_bytes || ticks_ != ticks) {
    plan_ = std::make_shared<const VisitPlan>(plan_visits(input.log, input.layout, input.node_rank,
                                                          static_cast<unsigned>(std::countr_zero(line_bytes)),
                                                          ticks));
    layout_ = input.config.layout;
    line_bytes_ = line_bytes;
    ticks_ = ticks;
  }
  return plan_;
}

}  // namespace marti::processors::walk
