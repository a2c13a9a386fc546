#include "memory/bus.h"

#include "memory/late_dram.h"

namespace marti::memory {

Bus::Bus(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site)
    : Banked(banks, site, config.clock.cycles(config.address_cycles), true),
      mode_(config.mode),
      beats_(config),
      address_(config.clock.cycles(config.address_cycles)),
      pending_(config.mode == BusMode::split ? site.ports : 0) {
  statistics_.links = 1;
}

sim::Ticks Bus::unloaded_read(std::uint32_t bytes) const {
  return sim::add_ticks(sim::add_ticks(address_, banks_.unloaded_read(bytes)), beats_(bytes));
}

void Bus::read_late(const Transaction& transaction) {
  const sim::Ticks now = site_.engine.now();
  const sim::Ticks start = take(now, address_);
  pending_[transaction.port] = {start - now, 0, 0, transaction.bytes};
  ask_late(transaction, false, sim::add_ticks(start, address_));
}

void Bus::late_read(const LateAccess& read) {
  const std::uint32_t port = read.transaction.port;
  pending_[port].wait_bank = read.start - read.arrival;
  pending_[port].bank = read.ready - read.start;
  post_reply(port, read.ready);
}

}  // namespace marti::memory
