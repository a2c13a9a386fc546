// The conservation laws of second-level caches.
#pragma once

#include <cstdint>

#include "processors/replay/replay.h"

namespace marti::processors {

/// First-level misses that the second level did not serve.
[[nodiscard]] std::int64_t misses_beyond_caches(const MachineConfig& config, const MachineResult& result);

/// Throws InternalError when a law is broken: what misses in the first level is what the second is asked for;
/// what misses in a shared second level, and every write, is an access of a bank.
void check_second_level_laws(const MachineConfig& config, const MachineResult& result);

}  // namespace marti::processors
