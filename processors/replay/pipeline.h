// The pipeline scheme, after LINKS-1: nodes search, test or shade, and rays go round between them.
// docs/internals/pipeline.md has its rules and the argument that it cannot deadlock.
#pragma once

#include "processors/replay/replay.h"

namespace marti::processors::replay {

/// replay() for Scheme::pipeline; `config` has been checked.
[[nodiscard]] MachineResult replay_pipeline(const program::WorkLog& log, const machine::MachineConfig& config,
                                            const ReplayOptions& options);

}  // namespace marti::processors::replay
