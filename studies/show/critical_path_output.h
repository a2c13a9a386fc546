// The critical path of a frame in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/run/run_result.h"

namespace marti::studies::show {

/// Adds the field critical_path to the object `machine`, as docs/result-schema.md describes it, if the path
/// was recorded; with `nodes` also the list of nodes.
void add_critical_path(const run::RunResult& result, bool nodes, nlohmann::ordered_json& machine);

/// Lines of the summary; none if the path was not recorded.
[[nodiscard]] std::string critical_path_lines(const run::RunResult& result);

}  // namespace marti::studies::show
