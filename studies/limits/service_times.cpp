#include "studies/limits/service_times.h"

namespace marti::studies::limits {

namespace {

using memory::BusMode;
using memory::InterconnectKind;

double ticks(sim::Ticks time) { return static_cast<double>(time); }

double beats(const memory::InterconnectConfig& interconnect, std::uint32_t bytes) {
  return static_cast<double>(interconnect.beats(bytes)) *
         ticks(interconnect.clock.cycles(interconnect.cycles_per_beat));
}

// Services of a cycle at one station: their number and time.
struct Services {
  double visits = 0.0;
  double time = 0.0;
  double squares = 0.0;

  void add(double number, double each) {
    visits += number;
    time += number * each;
    squares += number * each * each;
  }
  [[nodiscard]] Station station(double waits) const {
    return {visits, waits, time / visits, squares / visits / 2.0};
  }
};

}  // namespace

ServiceTimes service_times(const processors::machine::MachineConfig& machine) {
  const memory::InterconnectConfig& interconnect = machine.interconnect;
  ServiceTimes times;
  if (interconnect.kind == InterconnectKind::ideal) {
    times.transfer = ticks(memory::ideal_read(interconnect));
    return times;
  }
  times.data = beats(interconnect, machine.reference_bytes());
  times.bank_access = ticks(machine.banks.clock.cycles(machine.banks.access_cycles));
  times.bank_busy = ticks(machine.banks.clock.cycles(machine.banks.busy_cycles));
  if (interconnect.kind == InterconnectKind::crossbar) {
    times.transfer = 2.0 * ticks(interconnect.clock.cycles(interconnect.latency_cycles)) + times.data;
    return times;
  }
  times.address = ticks(interconnect.clock.cycles(interconnect.address_cycles));
  times.transfer = times.address + times.data;
  times.held = interconnect.mode == BusMode::held ? times.bank_access : 0.0;
  times.write = times.address + beats(interconnect, machine.layout.pixel_bytes);
  return times;
}

std::vector<Station> interconnect_stations(const processors::machine::MachineConfig& machine, double writes) {
  const ServiceTimes times = service_times(machine);
  if (machine.interconnect.kind == InterconnectKind::ideal || times.read_busy() <= 0.0) {
    return {};
  }
  Services services;
  if (machine.interconnect.kind == InterconnectKind::crossbar) {
    services.add(1.0 / machine.banks.count, times.data);
    return {services.station(1.0)};
  }
  if (machine.interconnect.mode == BusMode::held) {
    services.add(1.0, times.read_busy());
    services.add(writes, times.write);
    return {services.station(1.0)};
  }
  const double addresses = times.address > 0.0 ? 1.0 : 0.0;
  services.add(addresses, times.address);
  services.add(1.0, times.data);
  services.add(writes, times.write);
  return {services.station(1.0 + addresses)};
}

}  // namespace marti::studies::limits
