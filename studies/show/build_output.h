// The building of the tree in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "processors/replay/replay.h"
#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The field machine.build, as docs/result-schema.md describes it; the nodes one by one when `per_node`.
[[nodiscard]] nlohmann::ordered_json build_json(const processors::node::BuildResult& build, bool per_node);

/// Lines of the summary; empty when the tree is given.
[[nodiscard]] std::string build_lines(const run::RunResult& result);

}  // namespace marti::studies::show
