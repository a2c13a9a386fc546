#include "memory/arbitrated_bus.h"

#include <algorithm>

#include "memory/late_dram.h"

namespace marti::memory {

using sim::add_ticks;
using sim::Ticks;

ArbitratedBus::ArbitratedBus(const InterconnectConfig& config, const BankConfig& banks,
                             const InterconnectSite& site)
    : Banked(banks, site, config.clock.cycles(config.address_cycles), true),
      mode_(config.mode),
      arbitration_(config.arbitration),
      beats_(config),
      address_(config.clock.cycles(config.address_cycles)),
      ports_(site.ports),
      data_(site.ports),
      asking_(site.ports),
      last_(site.ports - 1) {
  statistics_.links = 1;
}

Ticks ArbitratedBus::unloaded_read(std::uint32_t bytes) const {
  return add_ticks(add_ticks(address_, banks_.unloaded_read(bytes)), beats_(bytes));
}

void ArbitratedBus::read(const Transaction& transaction) {
  ++statistics_.reads;
  ask(transaction, false);
}

void ArbitratedBus::write(const Transaction& transaction) {
  ++statistics_.writes;
  ask(transaction, true);
}

void ArbitratedBus::ask(const Transaction& transaction, bool write) {
  statistics_.bytes += transaction.bytes;
  ports_[transaction.port].requests.push_back({transaction, site_.engine.now(), write});
  asking_.insert(transaction.port);
  call_for_grant();
}

void ArbitratedBus::reply(std::uint32_t port) {
  ports_[port].ready = site_.engine.now();
  data_.insert(port);
  asking_.insert(port);
  call_for_grant();
}

void ArbitratedBus::call_for_grant() {
  if (!called_) {
    called_ = true;
    site_.engine.post(
        sim::Event::make(std::max(site_.engine.now(), free_at_), site_.memory_class, site_.first_component));
  }
}

std::uint32_t ArbitratedBus::choose() const {
  if (arbitration_ == Arbitration::fixed_priority) {
    return (data_.empty() ? asking_ : data_).at_or_after(0);
  }
  const std::uint32_t next = asking_.at_or_after(last_ + 1);
  return next != PortSet::none ? next : asking_.at_or_after(0);
}

void ArbitratedBus::proceed(std::uint32_t port, std::uint32_t sequence) {
  if (sequence > 0) {
    Banked::proceed(port, sequence);
    return;
  }
  grant();
}

void ArbitratedBus::late_read(const LateAccess& read) {
  Port& port = ports_[read.transaction.port];
  port.service.wait_bank = read.start - read.arrival;
  port.service.bank = read.ready - read.start;
  post_reply(read.transaction.port, read.ready);
}

void ArbitratedBus::grant() {
  called_ = false;
  const std::uint32_t winner = choose();
  Port& port = ports_[winner];
  last_ = winner;
  if (data_.at_or_after(winner) == winner) {
    data_.erase(winner);
    if (port.requests.empty()) {
      asking_.erase(winner);
    }
    grant_data(winner);
  } else {
    const Request request = port.requests.front();
    port.requests.erase(port.requests.begin());
    if (port.requests.empty()) {
      asking_.erase(winner);
    }
    request.write ? grant_write(request) : grant_read(request);
  }
  if (!asking_.empty()) {
    call_for_grant();
  }
}

void ArbitratedBus::take(Ticks asked, Ticks length) {
  const Ticks now = site_.engine.now();
  free_at_ = add_ticks(now, length);
  statistics_.busy += length;
  statistics_.waits.add(now - asked);
}

void ArbitratedBus::grant_data(std::uint32_t port) {
  const Ticks now = site_.engine.now();
  Service service = ports_[port].service;
  const Ticks data = beats_(ports_[port].bytes);
  service.wait_interconnect += now - ports_[port].ready;
  service.transfer += data;
  service.done = add_ticks(now, data);
  take(ports_[port].ready, data);
  statistics_.data += data;
  site_.client.read_done(port, service);
}

void ArbitratedBus::grant_read(const Request& request) {
  const auto& [port, address, bytes] = request.transaction;
  const Ticks now = site_.engine.now();
  const Ticks sent = add_ticks(now, address_);
  if (late()) {
    take(request.asked, address_);
    ports_[port].service = {0, now - request.asked, address_, 0, 0};
    ports_[port].bytes = bytes;
    ask_late(request.transaction, false, sent);
    return;
  }
  const BankAccess access = banks_.read(address, bytes, sent);
  Service service = {0, now - request.asked, address_, access.start - sent, access.ready - access.start};
  if (mode_ == BusMode::split) {
    take(request.asked, address_);
    ports_[port].service = service;
    ports_[port].bytes = bytes;
    post_reply(port, access.ready);
    return;
  }
  const Ticks data = beats_(bytes);
  service.transfer = add_ticks(address_, data);
  service.done = add_ticks(access.ready, data);
  take(request.asked, service.done - now);
  statistics_.data += data;
  statistics_.held += access.ready - sent;
  site_.client.read_done(port, service);
}

void ArbitratedBus::grant_write(const Request& request) {
  const Ticks data = beats_(request.transaction.bytes);
  const Ticks length = add_ticks(address_, data);
  statistics_.data += data;
  take(request.asked, length);
  if (late()) {
    ask_late(request.transaction, true, free_at_);
    return;
  }
  const BankAccess access = banks_.write(request.transaction.address, request.transaction.bytes, free_at_);
  site_.client.write_done(request.transaction.port, access.ready);
}

}  // namespace marti::memory
