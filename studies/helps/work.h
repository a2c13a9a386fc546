// The work of a run and of replays, and the least time of a frame on a changed machine, without a replay.
#pragma once

#include <cstdint>
#include <limits>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"

namespace marti::studies::helps {

/// A lower bound of the frame time of `changed`, which traces the frame that `machine` traced with `result`:
/// the steps of all rays take the same cycles on both, each step is some node's, and no node does two things
/// at a time. Time that depends on caches, memory, messages or building is left out. 0 with SIMT nodes.
[[nodiscard]] sim::Ticks least_time(const processors::machine::MachineConfig& machine,
                                    const processors::replay::MachineResult& result,
                                    const processors::machine::MachineConfig& changed);

/// About a nanosecond of one processor. It is counted, not timed, so that the same steps are measured on
/// every computer.
using Work = std::uint64_t;

inline constexpr Work unlimited_work = std::numeric_limits<Work>::max();

/// Of one replay that walks the whole work log, by the lines that it touches and its events.
[[nodiscard]] Work whole_replay_work(Work references, Work events);

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
