// The conservation laws of second-level caches.
#pragma once

#include <cstdint>

#include "processors/replay/replay.h"

namespace marti::processors::replay {

/// Number of first-level misses and prefetches that no private second level served.
[[nodiscard]] std::int64_t reads_beyond_caches(const machine::MachineConfig& config,
                                               const MachineResult& result);

/// Number of lines that banks and nodes' own memories read: those that no cache holds, and for each lock its
/// branch.
[[nodiscard]] std::int64_t reads_of_memory(const machine::MachineConfig& config, const MachineResult& result);

/// Throws InternalError when a law is broken: the misses and prefetches of the first level are the
/// references of the second; the misses of a shared second level, and all writes, are the accesses of the
/// banks.
void check_second_level_laws(const machine::MachineConfig& config, const MachineResult& result);

}  // namespace marti::processors::replay
