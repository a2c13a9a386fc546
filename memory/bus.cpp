#include "memory/bus.h"

namespace marti::memory {

using sim::add_ticks;
using sim::Ticks;

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

Ticks Bus::unloaded_read(std::uint32_t bytes) const {
  return add_ticks(add_ticks(address_, bank_access_), beats_(bytes));
}

Ticks Bus::take(Ticks arrival, Ticks length) {
  const Ticks start = link_.begin(arrival);
  link_.hold_until(add_ticks(start, length));
  statistics_.busy = add_ticks(statistics_.busy, length);
  statistics_.waits.add(start - arrival);
  return start;
}

void Bus::read(const Transaction& transaction) {
  ++statistics_.reads;
  statistics_.bytes += transaction.bytes;
  const Ticks now = site_.engine.now();
  if (mode_ == BusMode::split) {
    const Ticks start = take(now, address_);
    const Ticks sent = add_ticks(start, address_);
    const BankAccess access = banks_.read(transaction.address, sent);
    pending_[transaction.port] = {
        {0, start - now, address_, access.start - sent, access.ready - access.start}, transaction.bytes};
    if (site_.ports == 1) {
      // The one port asks for nothing before its data have come, so nothing can take the bus until then.
      send_data(transaction.port, access.ready);
    } else {
      site_.engine.post(
          sim::Event::make(access.ready, site_.reply_class, site_.first_component + transaction.port));
    }
    return;
  }
  const Ticks start = link_.begin(now);
  const Ticks sent = add_ticks(start, address_);
  const BankAccess access = banks_.read(transaction.address, sent);
  const Ticks data = beats_(transaction.bytes);
  const Ticks done = add_ticks(access.ready, data);
  take(now, done - start);
  site_.client.read_done(transaction.port, {done, start - now, add_ticks(address_, data), access.start - sent,
                                            access.ready - access.start});
}

void Bus::reply(std::uint32_t port) { send_data(port, site_.engine.now()); }

void Bus::send_data(std::uint32_t port, Ticks ready) {
  const Ticks data = beats_(pending_[port].bytes);
  const Ticks start = take(ready, data);
  Service service = pending_[port].service;
  service.wait_interconnect += start - ready;
  service.transfer += data;
  service.done = add_ticks(start, data);
  site_.client.read_done(port, service);
}

void Bus::write(const Transaction& transaction) {
  ++statistics_.writes;
  statistics_.bytes += transaction.bytes;
  const Ticks length = add_ticks(address_, beats_(transaction.bytes));
  const Ticks sent = add_ticks(take(site_.engine.now(), length), length);
  const BankAccess access = banks_.write(transaction.address, sent);
  site_.client.write_done(transaction.port, access.ready);
}

}  // namespace marti::memory
