// The network that carries messages between the nodes of a cluster, and to and from the host.
//
// A message is sent whole: `send` grants it, in order of sending, every link of its way and says at once when
// its last byte arrives. Links are first come first served by the time of sending; a message cuts through, so
// each hop adds its latency and waits for its link, and the data take their beats once.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "memory/wait_statistics.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::memory {

/// ideal: a fixed latency, no queue. bus: one message at a time. crossbar: a link into each port. mesh: a
/// rectangle of routers as square as the number of ports allows, x before y. hypercube: the least dimension
/// that holds all ports, lowest differing bit first.
enum class NetworkKind : std::uint8_t { ideal, bus, crossbar, mesh, hypercube };
inline constexpr std::array<std::string_view, 5> network_kind_names = {"ideal", "bus", "crossbar", "mesh",
                                                                       "hypercube"};

struct NetworkConfig {
  NetworkKind kind = NetworkKind::mesh;
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::uint32_t width = 4;           ///< bytes a beat of one link
  std::int64_t cycles_per_beat = 1;  ///< cycles to move one beat
  std::int64_t hop_cycles = 2;       ///< latency of each hop; ideal, bus, crossbar: of the whole way
};

/// The course of one message. `arrival` is `wait + transfer` after it was sent.
struct Delivery {
  sim::Ticks arrival = 0;
  sim::Ticks wait = 0;      ///< for links
  sim::Ticks transfer = 0;  ///< hops and beats
};

/// What went through a network. A message from a port to itself uses no link and is not counted.
struct NetworkStatistics {
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  std::int64_t hops = 0;
  std::int64_t links = 0;
  sim::Ticks busy = 0;
  WaitStatistics waits;  ///< of each message: all its links together

  static constexpr auto counters() {
    using C = sim::Counter<NetworkStatistics>;
    return std::array{
        C{"messages", "1", "messages between different ports", &NetworkStatistics::messages},
        C{"bytes", "byte", "bytes of these messages", &NetworkStatistics::bytes},
        C{"hops", "1", "links that they crossed", &NetworkStatistics::hops},
        C{"links", "1", "transfers possible at the same time", &NetworkStatistics::links},
        C{"busy", "ps", "time that messages held links, all together", &NetworkStatistics::busy}};
  }
};

class Network {
 public:
  virtual ~Network() = default;

  /// Sends `bytes` (at least 1) at `now`. Calls come in the order of simulated time. A message to its own
  /// port arrives at once.
  virtual Delivery send(sim::Ticks now, std::uint32_t from, std::uint32_t to, std::uint32_t bytes) = 0;

  [[nodiscard]] virtual const NetworkStatistics& statistics() const = 0;
};

/// The network that the configuration names, between ports 0 .. ports - 1. Throws UserError for a width of 0.
[[nodiscard]] std::unique_ptr<Network> make_network(const NetworkConfig& config, std::uint32_t ports);

}  // namespace marti::memory
