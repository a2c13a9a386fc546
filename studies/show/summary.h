// A run as text.
#pragma once

#include <string>

#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The summary's first part: the scene and its structure, of which nothing need be traced.
[[nodiscard]] std::string scene_summary_of(const run::RunResult& result);

/// The printed summary.
[[nodiscard]] std::string summary_of(const run::RunResult& result);

}  // namespace marti::studies::show
