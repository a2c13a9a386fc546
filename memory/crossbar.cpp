#include "memory/crossbar.h"

#include "memory/late_dram.h"

namespace marti::memory {

using sim::add_ticks;
using sim::Ticks;

Crossbar::Crossbar(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site)
    : Banked(banks, site, config.clock.cycles(config.latency_cycles), false),
      beats_(config),
      latency_(config.clock.cycles(config.latency_cycles)),
      links_(banks_.count()),
      pending_(late() ? site.ports : 0) {
  statistics_.links = banks_.count();
}

Ticks Crossbar::unloaded_read(std::uint32_t bytes) const {
  return add_ticks(add_ticks(add_ticks(latency_, banks_.unloaded_read(bytes)), beats_(bytes)), latency_);
}

void Crossbar::read(const Transaction& transaction) {
  ++statistics_.reads;
  statistics_.bytes += transaction.bytes;
  const Ticks arrival = add_ticks(site_.engine.now(), latency_);
  if (late()) {
    pending_[transaction.port].transaction = transaction;
    ask_late(transaction, false, arrival);
    return;
  }
  send_data(transaction, arrival, banks_.read(transaction.address, transaction.bytes, arrival));
}

void Crossbar::late_read(const LateAccess& read) {
  Pending& pending = pending_[read.transaction.port];
  pending.arrival = read.arrival;
  pending.access = {read.start, read.ready};
  post_reply(read.transaction.port, read.ready);
}

void Crossbar::reply(std::uint32_t port) {
  const Pending& pending = pending_[port];
  send_data(pending.transaction, pending.arrival, pending.access);
}

Ticks Crossbar::end_of_write(const LateAccess& write) const {
  return add_ticks(write.ready, beats_(write.transaction.bytes));
}

void Crossbar::send_data(const Transaction& transaction, Ticks arrival, const BankAccess& access) {
  const std::uint32_t bank = banks_.bank_of(transaction.address);
  const Ticks data = beats_(transaction.bytes);
  const Ticks start = links_[bank].begin(access.ready);
  const Ticks sent = add_ticks(start, data);
  links_[bank].hold_until(sent);
  statistics_.busy += data;
  statistics_.data += data;
  statistics_.waits.add(start - access.ready);
  const Ticks way = add_ticks(latency_, latency_);
  site_.client.read_done(transaction.port,
                         {add_ticks(sent, latency_), start - access.ready, add_ticks(way, data),
                          access.start - arrival, access.ready - access.start});
}

void Crossbar::write(const Transaction& transaction) {
  ++statistics_.writes;
  statistics_.bytes += transaction.bytes;
  statistics_.waits.add(0);
  const Ticks arrival = add_ticks(site_.engine.now(), latency_);
  if (late()) {
    ask_late(transaction, true, arrival);
    return;
  }
  const BankAccess access = banks_.write(transaction.address, transaction.bytes, arrival);
  site_.client.write_done(transaction.port, add_ticks(access.ready, beats_(transaction.bytes)));
}

}  // namespace marti::memory
