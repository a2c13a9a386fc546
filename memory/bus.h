// One bus for a cluster: one transfer at a time, first come first served.
#pragma once

#include "memory/banked.h"
#include "memory/link.h"
#include "sim/large_pages.h"
#include "sim/prefetch.h"

namespace marti::memory {

/// A read sends its address, waits for its bank, and receives its data; a write sends address and data in one
/// tenure and does not wait for the bank. In `held` mode a read keeps the bus from its address to its data;
/// in `split` mode it gives the bus back, and the data ask for the bus again when they are ready.
class Bus final : public Banked {
 public:
  Bus(const InterconnectConfig& config, const BankConfig& banks, const InterconnectSite& site);

  void read(const Transaction& transaction) override { read_for(site_.client, transaction); }
  void write(const Transaction& transaction) override { write_for(site_.client, transaction); }
  void reply(std::uint32_t port) override { reply_for(site_.client, port); }

  /// read(), write() and reply() for the site's client, with its own class, so that the compiler can join
  /// their code with that of the client.
  template <class Client>
  void read_for(Client& client, const Transaction& transaction);
  template <class Client>
  void write_for(Client& client, const Transaction& transaction);
  template <class Client>
  void reply_for(Client& client, std::uint32_t port) {
    send_data(client, port, pending_[port], site_.engine.now());
  }
  void prepare(std::uint32_t port) const override {
    if (port < pending_.size()) {
      sim::prefetch(pending_[port]);
    }
  }

  [[nodiscard]] const InterconnectStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override;

 private:
  // A split read between its address, which took address_, and its data. Two share a cache line of the host:
  // with many ports each is out of its caches when its data are ready.
  struct alignas(32) Pending {
    sim::Ticks wait_interconnect = 0;
    sim::Ticks wait_bank = 0;
    sim::Ticks bank = 0;
    std::uint32_t bytes = 0;
  };

  // Grants the bus to a tenure of `length` that arrives at `arrival`; returns when it starts.
  sim::Ticks take(sim::Ticks arrival, sim::Ticks length);
  // Sends the address of a read whose data are ready at a time that is not known yet.
  void read_late(const Transaction& transaction);
  void late_read(const LateAccess& read) override;
  // Sends the data of the port's read `read`, which are ready at `ready`. Joined with the caller, so that
  // what a read has taken is passed on in registers: compilers load what they have just stored in pieces of
  // another size, for which the host's processor waits.
  template <class Client>
  [[gnu::always_inline]] void send_data(Client& client, std::uint32_t port, const Pending& read,
                                        sim::Ticks ready);

  BusMode mode_;
  BeatTime beats_;
  sim::Ticks address_;
  Link link_;
  sim::LargeVector<Pending> pending_;
  InterconnectStatistics statistics_;
};

[[gnu::always_inline]] inline sim::Ticks Bus::take(sim::Ticks arrival, sim::Ticks length) {
  const sim::Ticks start = link_.begin(arrival);
  link_.hold_until(sim::add_ticks(start, length));
  statistics_.busy += length;
  statistics_.waits.add(start - arrival);
  return start;
}

template <class Client>
void Bus::read_for(Client& client, const Transaction& transaction) {
  using sim::add_ticks;
  ++statistics_.reads;
  statistics_.bytes += transaction.bytes;
  if (late()) [[unlikely]] {
    read_late(transaction);
    return;
  }
  const sim::Ticks now = site_.engine.now();
  if (mode_ == BusMode::split) {
    const sim::Ticks start = take(now, address_);
    const sim::Ticks sent = add_ticks(start, address_);
    const BankAccess access = banks_.read(transaction.address, transaction.bytes, sent);
    const Pending read = {start - now, access.start - sent, access.ready - access.start, transaction.bytes};
    if (site_.ports == 1 && !site_.writes_meanwhile) {
      // The one port asks for nothing before its data have come, so nothing can take the bus until then.
      send_data(client, transaction.port, read, access.ready);
    } else {
      pending_[transaction.port] = read;
      post_reply(transaction.port, access.ready);
    }
    return;
  }
  const sim::Ticks start = link_.begin(now);
  const sim::Ticks sent = add_ticks(start, address_);
  const BankAccess access = banks_.read(transaction.address, transaction.bytes, sent);
  const sim::Ticks data = beats_(transaction.bytes);
  const sim::Ticks done = add_ticks(access.ready, data);
  take(now, done - start);
  statistics_.data += data;
  statistics_.held += access.ready - sent;
  client.read_done(transaction.port, {done, start - now, add_ticks(address_, data), access.start - sent,
                                      access.ready - access.start});
}

template <class Client>
inline void Bus::send_data(Client& client, std::uint32_t port, const Pending& read, sim::Ticks ready) {
  const sim::Ticks data = beats_(read.bytes);
  const sim::Ticks start = take(ready, data);
  statistics_.data += data;
  client.read_done(port, {sim::add_ticks(start, data), read.wait_interconnect + (start - ready),
                          sim::add_ticks(address_, data), read.wait_bank, read.bank});
}

template <class Client>
void Bus::write_for(Client& client, const Transaction& transaction) {
  ++statistics_.writes;
  statistics_.bytes += transaction.bytes;
  const sim::Ticks data = beats_(transaction.bytes);
  const sim::Ticks length = sim::add_ticks(address_, data);
  statistics_.data += data;
  const sim::Ticks sent = sim::add_ticks(take(site_.engine.now(), length), length);
  if (late()) [[unlikely]] {
    ask_late(transaction, true, sent);
    return;
  }
  const BankAccess access = banks_.write(transaction.address, transaction.bytes, sent);
  client.write_done(transaction.port, access.ready);
}

}  // namespace marti::memory
