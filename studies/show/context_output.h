// Contexts and prefetching in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The field machine.contexts, as docs/result-schema.md describes it; the nodes one by one when `per_node`.
[[nodiscard]] nlohmann::ordered_json context_json(const processors::machine::MachineConfig& machine,
                                                  const processors::walk::ContextResult& result,
                                                  bool per_node);

/// Lines of the summary; empty with one context and no prefetch.
[[nodiscard]] std::string context_lines(const run::RunResult& result);

}  // namespace marti::studies::show
