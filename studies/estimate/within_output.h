// What `marti run --within` says when it has estimated: for people, and for programs.
#pragma once

#include <string>

#include "studies/estimate/within.h"
#include "studies/run/run_result.h"

namespace marti::studies::estimate {

/// What scene_summary_of() says, what was left out, and every figure with its error bar.
[[nodiscard]] std::string estimate_text(const run::RunResult& result, const EstimatedRun& run,
                                        const TracedPart& traced, double tolerance);

/// The figures as docs/error.md describes them.
[[nodiscard]] std::string estimate_json(const run::RunResult& result, const EstimatedRun& run,
                                        const TracedPart& traced, double tolerance);

}  // namespace marti::studies::estimate
