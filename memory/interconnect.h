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

/// held: a read keeps the bus from its address to its last data. split: it gives the bus back while the bank
/// works, and its data compete for the bus as a request does.
enum class BusMode : std::uint8_t { held, split };

/// Which of several asking ports gets the bus. fifo: the one that asked first. round_robin: the next one
/// after the port that had it last. fixed_priority: data before addresses and writes, then the lowest port.
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
  std::int64_t latency_cycles = 10;  ///< ideal: for a whole read or write; crossbar: in each direction

  /// How many beats move so many bytes; the width must not be 0.
  [[nodiscard]] std::int64_t beats(std::uint32_t bytes) const {
    return (std::int64_t{bytes} + width - 1) / width;
  }
};

/// One transaction of a port (a node of the cluster, counted from 0).
struct Transaction {
  std::uint32_t port = 0;
  Address address = 0;
  std::uint32_t bytes = 0;  ///< at least 1
};

/// The parts of a read's time. The four parts add up to `done` minus the time of the request.
struct Service {
  sim::Ticks done = 0;
  sim::Ticks wait_interconnect = 0;
  sim::Ticks transfer = 0;
  sim::Ticks wait_bank = 0;
  sim::Ticks bank = 0;
};

/// The issuer of transactions. Both calls may come during the request itself, with a future time, or later;
/// write_done also during a request of another port. A client must not make requests in them.
class InterconnectClient {
 public:
  virtual ~InterconnectClient() = default;
  virtual void read_done(std::uint32_t port, const Service& service) = 0;
  /// Reports the port's oldest write not reported yet: it leaves its write buffer at `done`. Each port's
  /// writes are reported in the order in which they were made. `done` is in the past only for a write that
  /// was done before an older one.
  virtual void write_done(std::uint32_t port, sim::Ticks done) = 0;
};

/// The traffic of an interconnect. `busy` is the sum of the transfer times of all links; `links` is the
/// number of transfers that are possible at the same time. What of `busy` is neither `data` nor `held` sends
/// addresses.
struct InterconnectStatistics {
  std::int64_t reads = 0;
  std::int64_t writes = 0;
  std::int64_t bytes = 0;
  std::int64_t links = 0;
  sim::Sum busy = 0;
  sim::Sum data = 0;
  sim::Sum held = 0;
  WaitStatistics waits;

  static constexpr auto counters() {
    using C = sim::Counter<InterconnectStatistics>;
    return std::array{C{"reads", "1", "read transactions", &InterconnectStatistics::reads},
                      C{"writes", "1", "posted writes", &InterconnectStatistics::writes},
                      C{"bytes", "byte", "data moved by both", &InterconnectStatistics::bytes},
                      C{"links", "1", "transfers possible at the same time", &InterconnectStatistics::links,
                        sim::MergeRule::sum, sim::Better::neither},
                      C{"busy", "ps", "transfer time of all links together", &InterconnectStatistics::busy},
                      C{"data", "ps", "part of it in which they move data", &InterconnectStatistics::data},
                      C{"held", "ps",
                        "part of it without a transfer: a held bus, while its bank works; the latency of a "
                        "network's bus, or of an ideal interconnect",
                        &InterconnectStatistics::held}};
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
  /// Counts reads that the port has made without calling read(), `bytes` in all, at any times. Only for an
  /// interconnect whose every read takes unloaded_read(), whatever other traffic there is.
  virtual void count_reads(std::int64_t reads, std::int64_t bytes);
  /// Handles the event of the site's reply class for `port`; called only if this interconnect posts such
  /// events.
  virtual void reply(std::uint32_t port);
  /// Handles the event of the site's memory class for `port` with this sequence number, if such are posted.
  virtual void proceed(std::uint32_t port, std::uint32_t sequence);
  /// Prefetches what is kept for a port into the host's caches. A hint: it affects nothing but speed.
  virtual void prepare(std::uint32_t port) const;
  /// As prepare(), a little later, for a port whose next event is one of the memory class: prefetches what
  /// that needs beside. Whether it will report the port's read as done.
  virtual bool prepare_more(std::uint32_t port) const;

  [[nodiscard]] virtual const InterconnectStatistics& statistics() const = 0;
  /// Statistics of the banks; empty where no banks are modelled.
  [[nodiscard]] virtual std::vector<BankStatistics> bank_statistics() const = 0;
  /// Statistics of each DRAM channel, for a frame that ends at `end`; empty without DRAM.
  [[nodiscard]] virtual std::vector<DramStatistics> dram_statistics(sim::Ticks /*end*/) const { return {}; }
  /// The destinations of accesses to a distributed memory; null for all others.
  [[nodiscard]] virtual const DistributedStatistics* distribution() const { return nullptr; }
  [[nodiscard]] virtual const NetworkStatistics* network_statistics() const { return nullptr; }
  /// Statistics of the cache before the banks; null without such a cache.
  [[nodiscard]] virtual const SharedCacheStatistics* cache_statistics() const { return nullptr; }
  /// Time of a read of `bytes` that meets no other transaction.
  [[nodiscard]] virtual sim::Ticks unloaded_read(std::uint32_t bytes) const = 0;
};

/// What an interconnect is connected to. The handler of the engine's events of `reply_class` and
/// `memory_class` passes each event to `reply` or `proceed` of the interconnect to which the event's
/// component belongs. The memory class comes after the classes in which requests are made, so that at its
/// events all requests of the instant are known.
struct InterconnectSite {
  sim::Engine& engine;
  InterconnectClient& client;
  std::uint8_t reply_class = 0;
  std::uint32_t first_component = 0;  ///< port p's events carry component first_component + p
  std::uint32_t ports = 0;
  std::uint8_t memory_class = 0;
  bool writes_meanwhile = false;  ///< a port may write while a read of its own is under way
};

/// The time of every read of an ideal interconnect.
[[nodiscard]] sim::Ticks ideal_read(const InterconnectConfig& config);

/// Builds the interconnect that the configuration names. Engine and client must outlive it.
[[nodiscard]] std::unique_ptr<Interconnect> make_interconnect(const InterconnectConfig& config,
                                                              const BankConfig& banks,
                                                              const InterconnectSite& site);

}  // namespace marti::memory
