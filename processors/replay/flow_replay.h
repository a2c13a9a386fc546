// The common part of the replays of all schemes in which rays move.
#pragma once

#include <functional>
#include <memory>

#include "processors/flow/flow_parts.h"
#include "processors/replay/replay.h"

namespace marti::processors::replay {

using MakeFlowNodes = std::function<std::unique_ptr<flow::FlowNodes>(const flow::FlowParts&)>;

/// Times a frame on nodes made by `make`, with at most `limit` rays in flight in each cluster, and checks the
/// laws of the result. Throws as replay() does.
[[nodiscard]] MachineResult replay_flow(const program::WorkLog& log, const machine::MachineConfig& config,
                                        const ReplayOptions& options, std::uint32_t limit,
                                        const MakeFlowNodes& make);

}  // namespace marti::processors::replay
