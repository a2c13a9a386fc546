// Replays of several machines at a time.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/memory_budget.h"
#include "studies/helps/work.h"

namespace marti::studies::helps {

/// What replays share: the work log, a stripped log for the machines that it suits (null: none), what the
/// replays are to keep, and the memory that is left for them.
struct SharedLog {
  const processors::program::WorkLog& log;
  std::shared_ptr<const processors::walk::StrippedLog> stripped;
  processors::replay::ReplayOptions options;
  sim::MemoryBudget memory;
  sim::WorkMeter* meter = nullptr;  ///< counts the replays; stopped, it stops them; null: nobody waits
};

/// The stripped log, if it suits the machine; else null.
[[nodiscard]] const processors::walk::StrippedLog* stripped_for(
    const SharedLog& shared, const processors::machine::MachineConfig& machine);

/// Bytes of the host's memory for a replay. A machine that cannot be built is refused by its replay.
[[nodiscard]] std::uint64_t bytes_of(const SharedLog& shared,
                                     const processors::machine::MachineConfig& machine);

struct Replayed {
  std::optional<sim::Ticks> end;  ///< std::nullopt: the replay was not finished
  bool no_memory = false;         ///< because the computer ran out of memory; else its time cannot be counted
  Work work = 0;
};

/// Replays each machine, none of which takes more than `most_bytes`. `packet_seeds`: the
/// ReplayOptions::packet_seed of each machine; empty: 0 for all, the order of packets that it asks for. As
/// many are replayed at a time as there are cores and memory for; results do not depend on it. Throws
/// sim::Stopped.
[[nodiscard]] std::vector<Replayed> replay_all(
    const SharedLog& shared, std::span<const processors::machine::MachineConfig* const> machines,
    std::uint64_t most_bytes, std::span<const std::uint64_t> packet_seeds = {});

}  // namespace marti::studies::helps
