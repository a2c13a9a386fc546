// Proves a plan on the very run that it was made for: the frame is rendered with each item kept in turn, and
// frame and machine are run with everything kept.
#pragma once

#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "studies/run/run_result.h"

namespace marti::studies::verify {

struct PlanVerdict {
  bool holds = true;
  std::string text;  ///< a line for each proof; a faulty one says what differs
};

/// Repeats the run once for each item left out, with that item kept, and once with all items kept. Must be
/// equal: the bits of all pixels, the hits of all rays, the work log word by word, and with all items kept
/// every figure of the machine. Where shadow rays were left out that no light could show, the log without
/// them must be equal, and the machine's figures may differ, because its rays do. If a part of a file that
/// was not read is broken, the verdict says that there is nothing to compare with.
[[nodiscard]] PlanVerdict verify_plan(const run::RunResult& result);

/// The log without the shadow rays and the lights at points of these materials (by index; averaged materials
/// have no entry).
[[nodiscard]] processors::program::WorkLog without_shadows_at(const std::vector<bool>& materials,
                                                              const processors::program::WorkLog& log);

/// For each material of a scene: whether it asks for lights although none adds anything.
[[nodiscard]] std::vector<bool> unlit_materials(const scenes::Scene& scene);

/// What differs between two logs, or an empty text.
[[nodiscard]] std::string difference_of(const processors::program::WorkLog& a,
                                        const processors::program::WorkLog& b);

}  // namespace marti::studies::verify
