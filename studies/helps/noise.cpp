#include "studies/helps/noise.h"

#include <fmt/format.h>

#include <algorithm>

namespace marti::studies::helps {

std::optional<OrderNoise> measure_noise(const SharedLog& shared,
                                        const processors::machine::MachineConfig& machine,
                                        const processors::replay::MachineResult& result, Work budget) {
  const Work one = std::max<Work>(1, replay_work(result, stripped_for(shared, machine)));
  const std::size_t orders = std::min<Work>(noise_orders, budget / one);
  const std::uint64_t bytes = bytes_of(shared, machine);
  if (orders < 2 || bytes > shared.memory.left() || result.end == 0 || result.packets < 2) {
    return std::nullopt;
  }
  sim::begin_part(shared.meter, "measuring the noise of other orders of packets", "machines", orders);
  const std::vector<const processors::machine::MachineConfig*> machines(orders, &machine);
  std::vector<std::uint64_t> seeds;
  for (std::size_t order = 0; order < orders; ++order) {
    seeds.push_back(order + 1);
  }
  OrderNoise noise{0, result.end, result.end};
  for (const Replayed& replayed : replay_all(shared, machines, bytes, seeds)) {
    if (replayed.end) {
      ++noise.replays;
      noise.shortest = std::min(noise.shortest, *replayed.end);
      noise.longest = std::max(noise.longest, *replayed.end);
    }
  }
  return noise.replays < 2 ? std::nullopt : std::optional(noise);
}

double band_of(const OrderNoise& noise, sim::Ticks end) {
  return static_cast<double>(noise.longest - noise.shortest) / static_cast<double>(end);
}

std::string noise_text(const OrderNoise& noise, sim::Ticks end) {
  return fmt::format("another order of packets changes the frame by up to {:.2f} % ({} replays)",
                     100.0 * band_of(noise, end), noise.replays);
}

}  // namespace marti::studies::helps
