// The plan of a run in the summary and in `result.json`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/run/plan/plan.h"

namespace marti::studies::run {

/// A line for each item that is left out, or would be and is kept; empty where nothing was at stake.
[[nodiscard]] std::string plan_lines(const Plan& plan);

[[nodiscard]] nlohmann::ordered_json plan_json(const Plan& plan);

}  // namespace marti::studies::run
