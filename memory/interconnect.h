// The interconnect between the nodes of a cluster and the cluster's shared memory.
//
// Requests arrive in the order of simulated time. Where service is first come, first served, an
// interconnect computes a transaction's whole course when it arrives; where a later phase competes with
// transactions that have not arrived yet (a split bus's reply, a bus that is granted by priority, a message
// that reaches another node's memory), it posts events of its own.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "memory/bank.h"
#include "memory/record_kind.h"
#include "memory/wait_statistics.h"
#include "sim/engine.h"
#include "sim/time.h"

namespace marti::memory {

enum class InterconnectKind : std::uint8_t { ideal, bus, crossbar };

/// held: a read keeps the bus from its address to its last data. split: it gives the bus back while the
/// bank works, and its data compete for the bus like a request.
enum class BusMode : std::uint8_t { held, split };

/// Whom a bus is granted to when several ask for it. fifo: who asked first. round_robin: the port after the
/// one that had it last. fixed_priority: data before addresses and writes, then the lowest port.
enum class Arbitration : std::uint8_t { fifo, round_robin, fixed_priority };
inline constexpr std::array<std::string_view, 3> arbitration_names = {"fifo", "round_robin",
                                                                      "fixed_priority"};

struct InterconnectConfig {
  InterconnectKind kind = InterconnectKind::bus;
  BusMode mode = BusMode::split;
  Arbitration arbitration = Arbitration::fifo;  ///< bus only
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::uint32_t width = 8;           ///< bytes a beat
  std::int64_t cycles_per_beat = 1;  ///< cycles to move one beat of data
  std::int64_t address_cycles = 1;   ///< bus: cycles to send an address
  std::int64_t latency_cycles = 10;  ///< ideal: a whole read or write; crossbar: one way through it
};

/// One transaction of a port (a node of the cluster, counted from 0).
struct Transaction {
  std::uint32_t port = 0;
  Address address = 0;
  std::uint32_t bytes = 0;  ///< at least 1
};

/// How a read's time divides. The four parts add up to `done` minus the time of the request.
struct Service {
  sim::Ticks done = 0;
  sim::Ticks wait_interconnect = 0;
  sim::Ticks transfer = 0;
  sim::Ticks wait_bank = 0;
  sim::Ticks bank = 0;
};

/// Who issues transactions. Both calls may come during the request itself and may name a future time; or they
/// come later.
class InterconnectClient {
 public:
  virtual ~InterconnectClient() = default;
  virtual void read_done(std::uint32_t port, const Service& service) = 0;
  /// The port's oldest write of which nothing was said yet has left its write buffer for good at `done`. Each
  /// port hears of its writes in the order in which it made them. `done` is past only for a write that was
  /// done before an older one.
  virtual void write_done(std::uint32_t port, sim::Ticks done) = 0;
};

/// What went through an interconnect. `busy` sums the transfers of all its links; `links` is how many can
/// transfer at the same time.
struct InterconnectStatistics {
  std::int64_t reads = 0;
  std::int64_t writes = 0;
  std::int64_t bytes = 0;
  std::int64_t links = 0;
  sim::Ticks busy = 0;
  WaitStatistics waits;

  static constexpr auto counters() {
    using C = sim::Counter<InterconnectStatistics>;
    return std::array{C{"reads", "1", "read transactions", &InterconnectStatistics::reads},
                      C{"writes", "1", "posted writes", &InterconnectStatistics::writes},
                      C{"bytes", "byte", "data moved by both", &InterconnectStatistics::bytes},
                      C{"links", "1", "transfers possible at the same time", &InterconnectStatistics::links},
                      C{"busy", "ps", "transfer time of all links together", &InterconnectStatistics::busy}};
  }
};

struct DistributedStatistics;
struct NetworkStatistics;

class Interconnect {
 public:
  virtual ~Interconnect() = default;

  /// A read at the engine's current time. A port has at most one read outstanding.
  virtual void read(const Transaction& transaction) = 0;
  /// A posted write at the engine's current time.
  virtual void write(const Transaction& transaction) = 0;
  /// Reads that the port has made by itself, without asking: only where every read takes unloaded_read()
  /// whatever else goes on. Any number, of so many bytes together, at any time.
  virtual void count_reads(std::int64_t reads, std::int64_t bytes);
  /// The event of the site's reply class for `port` has come up; only an interconnect that posts such
  /// events is ever called.
  virtual void reply(std::uint32_t port);
  /// The event of the site's memory class for `port`, with this sequence number, has come up; likewise.
  virtual void proceed(std::uint32_t port, std::uint32_t sequence);

  [[nodiscard]] virtual const InterconnectStatistics& statistics() const = 0;
  /// Statistics of the banks behind it; empty where no banks are modelled.
  [[nodiscard]] virtual const std::vector<BankStatistics>& bank_statistics() const = 0;
  /// Of a distributed memory, where the accesses went, and what its network carried; else null.
  [[nodiscard]] virtual const DistributedStatistics* distribution() const { return nullptr; }
  [[nodiscard]] virtual const NetworkStatistics* network_statistics() const { return nullptr; }
  /// Statistics of the cache before them; null where there is none.
  [[nodiscard]] virtual const SharedCacheStatistics* cache_statistics() const { return nullptr; }
  /// Time of a read of `bytes` that meets no other transaction.
  [[nodiscard]] virtual sim::Ticks unloaded_read(std::uint32_t bytes) const = 0;
};

/// Where an interconnect is plugged in. Whoever handles the engine's events of `reply_class` and
/// `memory_class` passes each on to `reply` or `proceed` of the interconnect whose ports the event's
/// component lies among. The memory class comes after those in which requests are made, so that at its events
/// all requests of the instant are known.
struct InterconnectSite {
  sim::Engine& engine;
  InterconnectClient& client;
  std::uint8_t reply_class = 0;
  std::uint32_t first_component = 0;  ///< port p's events carry component first_component + p
  std::uint32_t ports = 0;
  std::uint8_t memory_class = 0;
};

/// What every read of an ideal interconnect takes.
[[nodiscard]] sim::Ticks ideal_read(const InterconnectConfig& config);

/// Builds the interconnect that the configuration names. Engine and client must outlive it.
[[nodiscard]] std::unique_ptr<Interconnect> make_interconnect(const InterconnectConfig& config,
                                                              const BankConfig& banks,
                                                              const InterconnectSite& site);

}  // namespace marti::memory
