// The schemes in which rays move, in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "processors/replay/replay.h"
#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The field machine.flow, as docs/result-schema.md describes it; the nodes one by one when `per_node`.
[[nodiscard]] nlohmann::ordered_json flow_json(const processors::machine::MachineConfig& machine,
                                               const processors::replay::MachineResult& result,
                                               bool per_node);

/// Lines of the summary; empty with the image scheme.
[[nodiscard]] std::string flow_lines(const run::RunResult& result);

}  // namespace marti::studies::show
