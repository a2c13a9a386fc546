#include "memory/distributed.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::memory {

using sim::add_ticks;
using sim::Ticks;

namespace {

// Sequence numbers of a port's events: 0 is its read, 1 + n its write number n. A number is used again only
// long after the write that had it is done.
constexpr std::uint32_t write_numbers = (1U << sim::sequence_bits) - 1;

}  // namespace

Distributed::Distributed(const DistributedConfig& config, const InterconnectSite& site)
    : site_(site),
      nodes_(config.nodes),
      nodes_is_power_(std::has_single_bit(config.nodes)),
      ports_per_node_(site.ports / config.nodes),
      interleave_shift_(static_cast<std::uint32_t>(std::countr_zero(config.interleave))),
      header_(config.header_bytes),
      access_(config.clock.cycles(config.access_cycles)),
      beats_(config.clock.cycles(config.cycles_per_beat), config.width),
      network_(make_network(config.network, config.nodes)),
      homes_(config.nodes),
      reads_(site.ports),
      writes_(site.ports) {
  if (config.width == 0 || config.header_bytes == 0) {
    throw sim::UserError(
        "local memory must be at least one byte wide, and a message's header must not be empty");
  }
  if (!std::has_single_bit(config.interleave)) {
    throw sim::UserError("a distributed database is spread by an interleave that is a power of two");
  }
  sim::ensure(ports_per_node_ * nodes_ == site.ports, "the nodes of a distributed memory differ in ports");
  statistics_.links = network_->statistics().links;
}

Ticks Distributed::unloaded_read(std::uint32_t bytes) const {
  const Ticks memory = add_ticks(access_, beats_(bytes));
  __extension__ __int128 messages = 0;  // the sum may overflow though the mean fits
  for (std::uint32_t home = 1; home < nodes_; ++home) {
    messages += add_ticks(network_->unloaded(0, home, header_), network_->unloaded(home, 0, header_ + bytes));
  }
  return add_ticks(memory, static_cast<Ticks>(messages / nodes_));
}

BankAccess Distributed::access(std::uint32_t home, std::uint32_t bytes) {
  const Ticks now = site_.engine.now();
  Home& at = homes_[home];
  const Ticks start = std::max(now, at.free_at);
  const Ticks length = add_ticks(access_, beats_(bytes));
  at.free_at = add_ticks(start, length);
  if (start == now) [[likely]] {
    ++at.unwaited;
    at.unwaited_busy = add_ticks(at.unwaited_busy, length);
  } else {
    at.waited.add(length, start - now);
  }
  return {start, at.free_at};
}

std::vector<BankStatistics> Distributed::bank_statistics() const {
  std::vector<BankStatistics> banks;
  banks.reserve(homes_.size());
  for (const Home& home : homes_) {
    BankStatistics& bank = banks.emplace_back(home.waited);
    bank.accesses += home.unwaited;
    bank.busy = add_ticks(bank.busy, home.unwaited_busy);
    bank.waits.add_unwaited(home.unwaited);
  }
  return banks;
}

const InterconnectStatistics& Distributed::statistics() const {
  const NetworkStatistics& network = network_->statistics();
  statistics_.busy = network.busy;
  statistics_.data = network.data;
  statistics_.held = network.busy - network.data;
  statistics_.waits = network.waits;
  return statistics_;
}

Delivery Distributed::send(std::uint32_t from, std::uint32_t to, std::uint32_t bytes) {
  return network_->send(site_.engine.now(), from, to, bytes);
}

void Distributed::post(Ticks time, std::uint32_t port, std::uint32_t sequence) {
  site_.engine.post(sim::Event::make(time, site_.memory_class, site_.first_component + port, sequence));
}

void Distributed::read(const Transaction& transaction) {
  ++statistics_.reads;
  statistics_.bytes += transaction.bytes;
  const std::uint32_t node = node_of(transaction.port);
  const std::uint32_t home = home_of(transaction.address);
  if (home == node) {
    ++distribution_.local_reads;
    const Ticks now = site_.engine.now();
    const BankAccess served = access(home, transaction.bytes);
    site_.client.read_done(transaction.port,
                           {served.ready, 0, beats_(transaction.bytes), served.start - now, access_});
    return;
  }
  ++distribution_.remote_reads;
  const Delivery request = send(node, home, header_);
  reads_[transaction.port] = {{0, request.wait, request.transfer, 0, 0}, home, transaction.bytes, false};
  post(request.arrival, transaction.port, 0);
}

void Distributed::write(const Transaction& transaction) {
  ++statistics_.writes;
  statistics_.bytes += transaction.bytes;
  const std::uint32_t node = node_of(transaction.port);
  const std::uint32_t home = home_of(transaction.address);
  PortWrites& port = writes_[transaction.port];
  port.writes.push_back({home, transaction.bytes});
  if (home == node) {
    ++distribution_.local_writes;
    finish(transaction.port, port.writes.size() - 1, access(home, transaction.bytes).ready);
    return;
  }
  ++distribution_.remote_writes;
  const auto number = static_cast<std::uint32_t>((port.first + port.writes.size() - 1) % write_numbers);
  post(send(node, home, header_ + transaction.bytes).arrival, transaction.port, 1 + number);
}

void Distributed::proceed(std::uint32_t port, std::uint32_t sequence) {
  if (sequence != 0) {
    arrive(port, sequence - 1);
    return;
  }
  Read& read = reads_[port];
  if (!read.served) {
    const BankAccess served = access(read.home, read.bytes);
    read.served = true;
    read.service.wait_bank = served.start - site_.engine.now();
    read.service.bank = access_;
    read.service.transfer += beats_(read.bytes);
    post(served.ready, port, 0);
    return;
  }
  const Delivery data = send(read.home, node_of(port), header_ + read.bytes);
  site_.client.read_done(
      port, {data.arrival, read.service.wait_interconnect + data.wait, read.service.transfer + data.transfer,
             read.service.wait_bank, read.service.bank});
}

void Distributed::arrive(std::uint32_t port, std::uint32_t number) {
  const std::size_t place = (number + write_numbers - writes_[port].first) % write_numbers;
  const Write& write = writes_[port].writes[place];
  finish(port, place, access(write.home, write.bytes).ready);
}

void Distributed::finish(std::uint32_t port, std::size_t place, Ticks done) {
  PortWrites& p = writes_[port];
  p.writes[place].done = done;
  while (!p.writes.empty() && p.writes.front().done != not_done) {
    const Ticks oldest = p.writes.front().done;
    p.writes.erase(p.writes.begin());
    p.first = (p.first + 1) % write_numbers;
    site_.client.write_done(port, oldest);
  }
}

}  // namespace marti::memory
