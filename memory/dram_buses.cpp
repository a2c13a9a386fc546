#include "memory/dram_buses.h"

#include <algorithm>

namespace marti::memory {

DramBuses::DramBuses(const DramConfig& config)
    : steps_(config.steps()),
      period_(config.period),
      length_(config.timing_of_commands().bl),
      buses_(config.pseudo_channels ? config.ranks : 1),
      refreshes_(config.ranks) {}

void DramBuses::pause(Bus& bus, const Burst& burst, DramCycle data) const {
  const DramCycle from = bus.free - (data - burst.command);
  // What arrives in a cycle can have a command in the next one at the earliest.
  const DramCycle asked = std::clamp(whole(burst.asked + 1), from, burst.command);
  const Refresh& last = refreshes_[burst.rank];
  const DramCycle refresh =
      std::max<DramCycle>(0, std::min(whole(last.end), burst.command) - std::max(whole(last.due), asked));
  const DramCycle open = std::clamp(whole(std::max(burst.open, burst.arrival + 1)), asked, burst.command);
  bus.no_request += asked - from;
  bus.refresh += refresh;
  // A refresh closes all rows of its rank, so the row was opened after it.
  bus.rows += open - asked - refresh;
  bus.turn += burst.command - open;
}

void DramBuses::count(DramStatistics& statistics, sim::Ticks end) const {
  const auto ticks = [&](DramCycle step) { return sim::multiply_ticks(period_, step / steps_); };
  const auto add = [&](sim::Ticks& time, DramCycle part) { time = sim::add_ticks(time, ticks(part)); };
  statistics.data_buses += static_cast<std::int64_t>(buses_.size());
  for (const Bus& bus : buses_) {
    add(statistics.bus_rows, bus.rows);
    add(statistics.bus_refresh, bus.refresh);
    add(statistics.bus_turn, bus.turn);
    add(statistics.bus_no_request, bus.no_request);
    statistics.bus_no_request += end - ticks(bus.free);
  }
}

}  // namespace marti::memory
