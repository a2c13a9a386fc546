// The end of a frame whose packets take known times: the host gives each packet to the first node that is
// free.
#pragma once

#include <cstdint>
#include <span>

#include "processors/node/host.h"
#include "sim/time.h"

namespace marti::processors::node {

/// Assignment is dynamic; a packet's time counts from its start. Without packets, 0.
[[nodiscard]] sim::Ticks schedule_packets(const machine::HostConfig& host, std::uint32_t nodes,
                                          std::span<const sim::Ticks> packets);

}  // namespace marti::processors::node
