// Speed-up and bounds in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The field machine.bounds, as docs/result-schema.md describes it.
[[nodiscard]] nlohmann::ordered_json bounds_json(const run::RunResult& result);

/// Lines of the summary. Those of the loss are empty on one node, or when the frame takes no time.
[[nodiscard]] std::string loss_lines(const run::RunResult& result);
[[nodiscard]] std::string bound_lines(const run::RunResult& result);
/// What was recorded; empty when nothing was.
[[nodiscard]] std::string record_lines(const run::RunResult& result);

}  // namespace marti::studies::show
