// How much of a frame time is chance: the order in which packets happen to be handed out.
#pragma once

#include <optional>
#include <string>

#include "studies/helps/replays.h"

namespace marti::studies::helps {

/// The frame times of a machine whose packets are handed out in other orders.
struct OrderNoise {
  std::int64_t replays = 0;  ///< of other orders
  sim::Ticks shortest = 0;   ///< of them and of the order that was asked for
  sim::Ticks longest = 0;
};

/// So many other orders are replayed, where there is work for them; two at least.
inline constexpr std::size_t noise_orders = 5;

/// Replays the machine, which was timed with `result`, with its packets in orders that are drawn from the
/// seeds 1, 2, ... (ReplayOptions::packet_seed). The replays take `budget` at most, by what that of `result`
/// took. std::nullopt: there is no work or memory for two, a frame takes no time, or the frame has one
/// packet.
[[nodiscard]] std::optional<OrderNoise> measure_noise(const SharedLog& shared,
                                                      const processors::machine::MachineConfig& machine,
                                                      const processors::replay::MachineResult& result,
                                                      Work budget);

/// The band of the noise: the longest less the shortest of these frames, as a share of the frame time `end`,
/// which must not be 0. Another order makes a difference of that size by itself.
[[nodiscard]] double band_of(const OrderNoise& noise, sim::Ticks end);

/// "another order of packets changes the frame by up to 1.3 % (5 replays)".
[[nodiscard]] std::string noise_text(const OrderNoise& noise, sim::Ticks end);

}  // namespace marti::studies::helps
