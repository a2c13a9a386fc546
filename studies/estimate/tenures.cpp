#include "studies/estimate/tenures.h"

#include <cmath>

#include "memory/link.h"

namespace marti::studies::estimate {

Tenures tenures_of(const processors::machine::MachineConfig& machine) {
  const memory::InterconnectConfig& config = machine.interconnect;
  Tenures tenures;
  if (config.kind == memory::InterconnectKind::ideal) {
    tenures.last_write = config.clock.cycles(config.latency_cycles);
    tenures.miss = static_cast<double>(tenures.last_write);
    return tenures;
  }
  const memory::BeatTime beats(config);
  const auto address = static_cast<double>(config.clock.cycles(config.address_cycles));
  const auto line = static_cast<double>(beats(machine.cache.cache.line));
  const auto pixel = static_cast<double>(beats(machine.layout.pixel_bytes));
  const auto bank = static_cast<double>(machine.banks.clock.cycles(machine.banks.access_cycles));
  const bool held = config.mode == memory::BusMode::held;
  tenures.bus = true;
  tenures.read = address + line + (held ? bank : 0.0);
  tenures.write = address + pixel;
  tenures.per_read = held ? 1.0 : 2.0;
  tenures.miss = address + bank + line;
  tenures.bank_busy = held ? 0.0 : static_cast<double>(machine.banks.clock.cycles(machine.banks.busy_cycles));
  tenures.last_write = std::llround(address + pixel + bank);
  return tenures;
}

}  // namespace marti::studies::estimate
