// How packets are given to nodes, and what that costs.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "sim/time.h"

namespace marti::processors::machine {

/// dynamic: a node that is free asks for the next packet. interleaved: node i of n has packets i, i + n,
/// i + 2n, ... from the start. blocks: node i has the i-th n-th of the packets in a row.
enum class Assignment : std::uint8_t { dynamic, interleaved, blocks };
inline constexpr std::array<std::string_view, 3> assignment_names = {"dynamic", "interleaved", "blocks"};

struct HostConfig {
  Assignment assignment = Assignment::dynamic;
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::int64_t latency_cycles = 100;  ///< dynamic: from a node's request to the start of its packet
  std::int64_t occupancy_cycles = 0;  ///< dynamic: how long one request keeps the host from the next
};

}  // namespace marti::processors::machine
