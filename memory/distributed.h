// The memory of a cluster, spread over its nodes and reached over a network.
//
// After the machines of Green, Paddon, Exploiting coherence for multiprocessor ray tracing, IEEE CG&A 9(6),
// 1989, and Badouel, Priol, An efficient parallel ray tracing scheme for highly parallel architectures,
// Advances in Computer Graphics Hardware V, 1990 (Springer 1992): each node's own memory holds a part of the
// database, and a node caches what it reads of the others' parts.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "memory/beats.h"
#include "memory/interconnect.h"
#include "memory/network.h"
#include "sim/large_pages.h"
#include "sim/prefetch.h"

namespace marti::memory {

struct DistributedConfig {
  std::uint32_t nodes = 1;         ///< of the cluster; the site's ports are divided equally among them
  std::uint32_t interleave = 32;   ///< bytes in a row at one node; a power of two
  std::uint32_t header_bytes = 8;  ///< of a request; also the header of data and of a write; at least 1
  sim::Clock clock = sim::Clock::from_hertz(33e6);  ///< of a node's memory
  std::uint32_t width = 8;                          ///< bytes a beat of that memory
  std::int64_t access_cycles = 4;
  std::int64_t cycles_per_beat = 1;
  NetworkConfig network;
};

/// Accesses by destination. A home is the node whose memory holds the bytes.
struct DistributedStatistics {
  std::int64_t local_reads = 0;
  std::int64_t remote_reads = 0;
  std::int64_t local_writes = 0;
  std::int64_t remote_writes = 0;

  static constexpr auto counters() {
    using C = sim::Counter<DistributedStatistics>;
    return std::array{
        C{"local_reads", "1", "reads of the node's own memory", &DistributedStatistics::local_reads,
          sim::MergeRule::sum, sim::Better::neither},
        C{"remote_reads", "1", "reads of another node's: two messages", &DistributedStatistics::remote_reads},
        C{"local_writes", "1", "writes to the node's own memory", &DistributedStatistics::local_writes,
          sim::MergeRule::sum, sim::Better::neither},
        C{"remote_writes", "1", "writes to another node's: one message",
          &DistributedStatistics::remote_writes}};
  }
};
static_assert(sim::declares_every_member<DistributedStatistics>());

/// Unit u of the address space is at home u mod nodes. A home's memory serves one access at a time, in order
/// of arrival, whether it comes from its own node or from another; an access takes `access_cycles` and the
/// beats of its bytes. A read from another home sends a request, and the data come back when the memory has
/// served it. A write to another home sends header and bytes and is done when the memory has served it; there
/// is no reply. At one instant a node's own accesses come before those that arrive over the network.
///
/// The interconnect's `busy`, `links` and `waits` are those of the network; banks are the homes' memories.
class Distributed final : public Interconnect {
 public:
  /// Throws UserError for a width of 0 and for an interleave that is not a power of two.
  Distributed(const DistributedConfig& config, const InterconnectSite& site);

  void read(const Transaction& transaction) override;
  void write(const Transaction& transaction) override;
  void proceed(std::uint32_t port, std::uint32_t sequence) override;
  void prepare(std::uint32_t port) const override { sim::prefetch(reads_[port]); }
  bool prepare_more(std::uint32_t port) const override {
    const Read& read = reads_[port];
    if (!read.served) {
      sim::prefetch_line(&homes_[read.home]);
    }
    return read.served;
  }
  [[nodiscard]] const InterconnectStatistics& statistics() const override;
  [[nodiscard]] std::vector<BankStatistics> bank_statistics() const override;
  /// The mean over all homes, for node 0, rounded down.
  [[nodiscard]] sim::Ticks unloaded_read(std::uint32_t bytes) const override;

  [[nodiscard]] const DistributedStatistics* distribution() const override { return &distribution_; }
  [[nodiscard]] const NetworkStatistics* network_statistics() const override {
    return &network_->statistics();
  }

 private:
  // A port's read, from its request to its data. It lies in one cache line of the host, as does most of what
  // is kept of a home: with many nodes these are out of the host's caches at each read.
  struct alignas(64) Read {
    Service service;
    std::uint32_t home = 0;
    std::uint32_t bytes = 0;
    bool served = false;  // the memory has served it; the data must still be sent
  };
  static_assert(sizeof(Read) == 64);
  // A port's write that has not reached its home yet, or that is done before an older one.
  struct Write {
    std::uint32_t home = 0;
    std::uint32_t bytes = 0;
    sim::Ticks done = not_done;
  };
  struct PortWrites {
    std::vector<Write> writes;  // oldest first; few: what the write buffer holds
    std::uint32_t first = 0;    // number of the oldest
  };
  // The memory of a node. Accesses that do not wait, nearly all, are counted beside the others.
  struct alignas(64) Home {
    sim::Ticks free_at = 0;
    std::int64_t unwaited = 0;
    sim::Ticks unwaited_busy = 0;
    BankStatistics waited;
  };
  static constexpr sim::Ticks not_done = -1;

  [[nodiscard]] std::uint32_t home_of(Address address) const {
    const Address unit = address >> interleave_shift_;
    return static_cast<std::uint32_t>(nodes_is_power_ ? unit & (nodes_ - 1) : unit % nodes_);
  }
  [[nodiscard]] std::uint32_t node_of(std::uint32_t port) const {
    return ports_per_node_ == 1 ? port : port / ports_per_node_;
  }
  // Starts an access of `bytes` that arrives at the home now; returns its start and its end.
  BankAccess access(std::uint32_t home, std::uint32_t bytes);
  Delivery send(std::uint32_t from, std::uint32_t to, std::uint32_t bytes);
  void post(sim::Ticks time, std::uint32_t port, std::uint32_t sequence);
  // Write `number` of the port reaches its home.
  void arrive(std::uint32_t port, std::uint32_t number);
  // The port's write at this place in its list is done at `done`.
  void finish(std::uint32_t port, std::size_t place, sim::Ticks done);

  InterconnectSite site_;
  std::uint32_t nodes_;
  bool nodes_is_power_;
  std::uint32_t ports_per_node_;
  std::uint32_t interleave_shift_;
  std::uint32_t header_;
  sim::Ticks access_;
  Beats beats_;
  std::unique_ptr<Network> network_;
  sim::LargeVector<Home> homes_;
  sim::LargeVector<Read> reads_;               // of each port
  std::vector<PortWrites> writes_;             // of each port
  mutable InterconnectStatistics statistics_;  // what the network counts is entered when asked for
  DistributedStatistics distribution_;
};

}  // namespace marti::memory
