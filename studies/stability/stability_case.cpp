#include "studies/stability/stability_case.h"

#include <fmt/format.h>

#include <exception>
#include <limits>

#include "sim/error.h"

namespace marti::studies::stability {

CaseOutcome none_wrong(const Tally& tally, std::string_view what) {
  if (tally.of == 0) {
    return {fmt::format("no {} tried", what), 1.0, 0.0};
  }
  return {fmt::format("{} of {} {}", tables::grouped(tally.wrong), tables::grouped(tally.of), what),
          static_cast<double>(tally.wrong), 0.0};
}

CaseOutcome error_within(double error, double limit, std::string_view what) {
  return {fmt::format("{} {:.2g}, at most {:.2g}", what, error, limit), error, limit};
}

CaseOutcome refuses(const std::function<void()>& call, std::string_view words) {
  try {
    call();
  } catch (const sim::UserError& error) {
    const std::string message = error.what();
    if (message.find(words) != std::string::npos) {
      return {"refused: " + message, 0.0, 0.0};
    }
    return {"refused for another reason: " + message, 1.0, 0.0};
  }
  return {"not refused", 1.0, 0.0};
}

CaseOutcome run_case(const StabilityCase& one, const CaseSize& size) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  try {
    return one.run(size);
  } catch (const std::exception& error) {
    return {std::string("ended by: ") + error.what(), nothing, 0.0};
  }
}

std::vector<StabilityCase> stability_cases() {
  std::vector<StabilityCase> cases;
  add_kernel_cases(cases);
  add_structure_cases(cases);
  add_scene_cases(cases);
  add_precision_cases(cases);
  add_origin_cases(cases);
  add_input_cases(cases);
  add_time_cases(cases);
  add_overflow_cases(cases);
  add_queue_cases(cases);
  add_cache_cases(cases);
  add_scale_cases(cases);
  add_order_cases(cases);
  return cases;
}

}  // namespace marti::studies::stability
