// The network that carries messages between the nodes of a cluster, and to and from the host.
//
// A message is sent whole: `send` grants it, in order of sending, every link of its way and returns the
// arrival of its last byte at once. Links are first come first served by the time of sending. A message cuts
// through (Kermani, Kleinrock, Virtual cut-through, Computer Networks 3, 1979): its head waits for each link
// in turn and crosses it in the latency of a hop, each link is held for the beats of the data, and the last
// byte arrives these beats after the head. Routers have unlimited buffers.
//
// Ports 0 .. nodes - 1 are the nodes, port `nodes` is the host. In a mesh and a hypercube each node has a
// router, which it reaches without a link, and the host is connected to node 0's router by a link of its own
// in each direction, so it does not enlarge the mesh or hypercube.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "memory/wait_statistics.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::memory {

/// ideal: a fixed latency, no queue and no links. bus: one message at a time, latency and beats. crossbar: a
/// link into each port. mesh and hypercube: see routes.h.
enum class NetworkKind : std::uint8_t { ideal, bus, crossbar, mesh, hypercube };
inline constexpr std::array<std::string_view, 5> network_kind_names = {"ideal", "bus", "crossbar", "mesh",
                                                                       "hypercube"};

struct NetworkConfig {
  NetworkKind kind = NetworkKind::mesh;
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::uint32_t width = 4;           ///< bytes a beat of one link
  std::int64_t cycles_per_beat = 1;  ///< cycles to move one beat
  std::int64_t hop_cycles = 2;       ///< latency of a hop; ideal, bus, crossbar: of the whole way
};

/// The course of one message. `arrival` is `wait + transfer` after it was sent.
struct Delivery {
  sim::Ticks arrival = 0;
  sim::Ticks wait = 0;      ///< waiting for links
  sim::Ticks transfer = 0;  ///< hops and beats
};

/// The traffic of a network. A message from a port to itself uses no link and is not counted.
struct NetworkStatistics {
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  std::int64_t hops = 0;
  std::int64_t link_bytes = 0;
  std::int64_t links = 0;
  sim::Sum busy = 0;
  sim::Sum data = 0;
  WaitStatistics waits;  ///< one for each message, the sum over its links

  static constexpr auto counters() {
    using C = sim::Counter<NetworkStatistics>;
    return std::array{
        C{"messages", "1", "messages between different ports", &NetworkStatistics::messages},
        C{"bytes", "byte", "bytes of these messages", &NetworkStatistics::bytes},
        C{"hops", "1", "links that they crossed; ideal: none", &NetworkStatistics::hops},
        C{"link_bytes", "byte", "bytes times the links that they crossed; ideal: none",
          &NetworkStatistics::link_bytes},
        C{"links", "1", "transfers possible at the same time", &NetworkStatistics::links, sim::MergeRule::sum,
          sim::Better::neither},
        C{"busy", "ps", "time that messages held links, all together", &NetworkStatistics::busy},
        C{"data", "ps", "part of it in which their bytes moved; of a bus the rest is its latency",
          &NetworkStatistics::data}};
  }
};

class Network {
 public:
  virtual ~Network() = default;

  /// Sends `bytes` (at least 1) at `now`. Calls come in the order of simulated time. A message to its own
  /// port arrives at once. Messages between the same two ports arrive in the order of sending.
  virtual Delivery send(sim::Ticks now, std::uint32_t from, std::uint32_t to, std::uint32_t bytes) = 0;

  /// Time of a message when there is no other traffic; 0 to its own port.
  [[nodiscard]] virtual sim::Ticks unloaded(std::uint32_t from, std::uint32_t to,
                                            std::uint32_t bytes) const = 0;

  [[nodiscard]] virtual const NetworkStatistics& statistics() const = 0;
};

/// The network that the configuration names, between `nodes` nodes (at least 1) and the host. Throws
/// UserError for a width of 0.
[[nodiscard]] std::unique_ptr<Network> make_network(const NetworkConfig& config, std::uint32_t nodes);

/// Bytes of host memory for the links of such a network.
[[nodiscard]] std::uint64_t network_bytes(const NetworkConfig& config, std::uint32_t nodes);

}  // namespace marti::memory
