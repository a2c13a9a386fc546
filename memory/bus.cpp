#include "memory/bus.h"

namespace marti::memory {

Bus::Bus(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site)
    : site_(site),
      mode_(config.mode),
      beats_(config),
      address_(config.clock.cycles(config.address_cycles)),
      bank_access_(banks.clock.cycles(banks.access_cycles)),
      banks_(banks),
      pending_(config.mode == BusMode::split ? site.ports : 0) {
  statistics_.links = 1;
}

sim::Ticks Bus::unloaded_read(std::uint32_t bytes) const {
  return sim::add_ticks(sim::add_ticks(address_, bank_access_), beats_(bytes));
}

}  // namespace marti::memory
