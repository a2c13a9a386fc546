// Who holds which region.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processors/machine/flow_config.h"

namespace marti::processors {

/// Runs of neighbouring regions, of equal number as far as it goes: region i to part floor(i parts /
/// regions).
[[nodiscard]] std::vector<std::uint32_t> deal_in_blocks(std::uint32_t regions, std::uint32_t parts);

/// Region i to part i modulo parts.
[[nodiscard]] std::vector<std::uint32_t> deal_scattered(std::uint32_t regions, std::uint32_t parts);

/// The heaviest region first, equal ones by number, each to the part that has the least so far: of equals the
/// one with fewer regions, then the lower number. The heaviest part has at most 4/3 - 1/(3 parts) times what
/// the heaviest of the best division has (Graham, Bounds on multiprocessing timing anomalies, SIAM J. Appl.
/// Math. 17(2), 1969). Regions without weight go to the parts with the fewest regions. The weights' sum must
/// fit in 64 bits.
[[nodiscard]] std::vector<std::uint32_t> deal_balanced(std::span<const std::uint64_t> weights,
                                                       std::uint32_t parts);

}  // namespace marti::processors
