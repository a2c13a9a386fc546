// Configurations of sweeps for tests.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/config.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace marti::test {

inline sim::Config sweep_config(std::string_view text, const std::vector<std::string>& assignments = {}) {
  static const sim::Schema schema = studies::sweep::sweep_schema();
  return sim::Config::from_text(schema, text, "s.toml", assignments);
}

inline studies::sweep::SweepPlan plan_of(std::string_view text,
                                         const std::vector<std::string>& assignments = {}) {
  sim::Config config = sweep_config(text, assignments);
  return studies::sweep::plan_sweep(config);
}

}  // namespace marti::test
