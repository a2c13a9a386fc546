#include "memory/dram.h"

#include <algorithm>

namespace marti::memory {

Dram::Dram(const DramConfig& config)
    : clock_(config),
      mapping_(config),
      burst_bytes_(config.burst_bytes),
      burst_ticks_(config.burst_time()),
      channels_(config.channels, DramInOrder(config)) {}

Dram::Times Dram::access(Address address, std::uint32_t bytes, bool write, sim::Ticks arrival) {
  const DramRequest request{mapping_.place(address), bursts_of(address, bytes, burst_bytes_), write,
                            clock_.cycle_at(arrival)};
  const DramService service = channels_[request.place.channel].serve(request);
  return {request.place.channel, clock_.cycle_before(service.first), clock_.ticks(service.end),
          sim::multiply_ticks(burst_ticks_, request.bursts)};
}

std::vector<DramStatistics> Dram::statistics(sim::Ticks end) const {
  std::vector<DramStatistics> all;
  for (const DramInOrder& channel : channels_) {
    all.push_back(channel.statistics(end));
  }
  return all;
}

sim::Ticks unloaded_dram_read(const DramConfig& config, std::uint32_t bytes) {
  const DramTiming times = config.timing_of_commands();
  const std::int64_t more = bursts_of(0, bytes, config.burst_bytes) - 1;
  return sim::multiply_ticks(config.period, 1 + times.rcd + more * times.ccd_l + times.cl + times.bl);
}

}  // namespace marti::memory
