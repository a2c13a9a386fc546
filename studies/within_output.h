// What `marti run --within` says when it has estimated: for people, and for programs.
#pragma once

#include <cstdint>
#include <string>

#include "studies/run_result.h"
#include "studies/within.h"

namespace marti::studies {

/// Every figure with its error bar, below what scene_summary_of() says.
[[nodiscard]] std::string estimate_text(const EstimatedRun& run, double tolerance, std::uint32_t nodes);

/// The same as docs/error.md describes it. Of the result: the configuration and the machine.
[[nodiscard]] std::string estimate_json(const RunResult& result, const EstimatedRun& run, double tolerance);

}  // namespace marti::studies
