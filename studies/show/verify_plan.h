// The proof of a plan on the very run that it was made for: the run is done again with everything kept.
#pragma once

#include <string>

#include "processors/program/work_log.h"
#include "studies/run/run_result.h"

namespace marti::studies::show {

struct PlanVerdict {
  bool holds = true;
  std::string text;  ///< a line for the summary; a faulty one says what differs
};

/// Runs the frame and the machine once more with all items kept that the plan left out. Must be equal: the
/// bits of all pixels, the hits of all rays, the work log word by word and all that `result.json` says of the
/// machine. Shadow rays that no light could show are the program's own decision: if any were left out, a
/// second frame with them must have the same pixels. If a part of a file that was not read is broken, the
/// verdict says that there is nothing to compare with.
[[nodiscard]] PlanVerdict verify_plan(const run::RunResult& result);

/// What differs between two logs, or an empty text.
[[nodiscard]] std::string difference_of(const processors::program::WorkLog& a,
                                        const processors::program::WorkLog& b);

}  // namespace marti::studies::show
