// The work of a run and of replays, in units that do not depend on the computer.
#pragma once

#include <cstdint>
#include <limits>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"

namespace marti::studies::helps {

/// About a nanosecond of one processor. It is counted, not timed, so that the same steps are measured on
/// every computer.
using Work = std::uint64_t;

inline constexpr Work unlimited_work = std::numeric_limits<Work>::max();

/// Of one replay, from what it counted. `stripped`: the log that it walked; null: the whole work log.
[[nodiscard]] Work replay_work(const processors::replay::MachineResult& result,
                               const processors::walk::StrippedLog* stripped);

/// Of a run: tracing the frame of `totals`, stripping the log unless `stripped` is null, and the replays of
/// the machine and of one node of it.
[[nodiscard]] Work run_work(const processors::program::LogTotals& totals,
                            const processors::replay::MachineResult& machine,
                            const processors::replay::MachineResult& one_node,
                            const processors::walk::StrippedLog* stripped);

}  // namespace marti::studies::helps
