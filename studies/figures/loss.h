// The lost speed-up by cause.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "processors/replay/replay.h"

namespace marti::studies {

/// Why n nodes together spend more time than one node. Each part is the time of some activities summed over
/// all n nodes, less that of the one node. It may be negative: n caches can hold more than one.
enum class Loss : std::uint8_t {
  extra_misses,  ///< traversal, intersection, shading, cache_access, transfer, bank_access
  contention,    ///< interconnect_wait, bank_wait
  imbalance,     ///< idle and message_wait of nodes that had work
  overhead,      ///< building, switching, messaging, lock_wait, queue_full_wait, dispatch_wait
  idle,          ///< idle and message_wait of nodes that never had work
};
inline constexpr std::size_t losses = 5;
inline constexpr std::array<std::string_view, losses> loss_names = {"extra_misses", "contention", "imbalance",
                                                                    "overhead", "idle"};

/// The parts add up to `total` exactly.
struct SpeedUpLoss {
  sim::Ticks total = 0;                    ///< n T(n) - T(1)
  std::array<sim::Ticks, losses> parts{};  ///< by Loss
};

/// `one` is the same machine with one node, timed on the same log. Throws InternalError when the parts do not
/// add up, UserError when n T(n) does not fit.
[[nodiscard]] SpeedUpLoss loss_of(const processors::MachineResult& one, const processors::MachineResult& all);

}  // namespace marti::studies
