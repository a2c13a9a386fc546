// The second level of caches in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The field machine.l2, as docs/result-schema.md describes it; the caches one by one when `per_cache`.
[[nodiscard]] nlohmann::ordered_json second_level_json(const processors::machine::MachineConfig& machine,
                                                       const processors::replay::MachineResult& result,
                                                       bool per_cache);

/// A line of the summary; empty without a second level.
[[nodiscard]] std::string second_level_line(const run::RunResult& result);

}  // namespace marti::studies::show
