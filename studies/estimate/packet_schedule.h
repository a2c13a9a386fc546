// When a frame ends whose packets take known times: the host hands them out to whoever is free.
#pragma once

#include <cstdint>
#include <span>

#include "processors/node/host.h"
#include "sim/time.h"

namespace marti::studies {

/// With dynamic assignment; a packet's time counts from its start. Without packets, 0.
[[nodiscard]] sim::Ticks schedule_packets(const processors::HostConfig& host, std::uint32_t nodes,
                                          std::span<const sim::Ticks> packets);

}  // namespace marti::studies
