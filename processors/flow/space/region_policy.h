// Which node holds which region.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processors/machine/flow_config.h"

namespace marti::processors::flow {

/// Runs of neighbouring regions, as equal in number as possible: region i goes to part floor(i parts /
/// regions).
[[nodiscard]] std::vector<std::uint32_t> deal_in_blocks(std::uint32_t regions, std::uint32_t parts);

/// Region i to part i modulo parts.
[[nodiscard]] std::vector<std::uint32_t> deal_scattered(std::uint32_t regions, std::uint32_t parts);

/// Deals the heaviest region first, equal ones by number, each to the part with the least weight so far;
/// among equals to the one with fewer regions, then to the lower number. The heaviest part has at most 4/3 -
/// 1/(3 parts) times the weight of the heaviest part in the best division (Graham, Bounds on multiprocessing
/// timing anomalies, SIAM J. Appl. Math. 17(2), 1969). Regions without weight go to the parts with the fewest
/// regions. The weights' sum must fit in 64 bits.
[[nodiscard]] std::vector<std::uint32_t> deal_balanced(std::span<const std::uint64_t> weights,
                                                       std::uint32_t parts);

}  // namespace marti::processors::flow
