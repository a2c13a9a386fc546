// The host of the schemes in which rays move: sends camera rays into each cluster and collects what the rays
// contribute to the pixels.
//
// There is one host for the frame, with a link of its own into each cluster's network (port `nodes`). A
// cluster's camera rays are those of its current packet, pixel by pixel, row by row, sample by sample; when
// the packet is used up, the cluster takes the next packet of the frame. The first ray may be sent after
// `latency_cycles`, and each keeps that cluster's link busy for `occupancy_cycles`. Rays enter while fewer
// than a limit are in flight.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/machine/packets.h"
#include "processors/node/host.h"
#include "processors/program/work_log.h"
#include "processors/walk/observer.h"

namespace marti::processors::flow {

/// A sample of a pixel whose camera ray has been sent, and its words in the log.
struct SentSample {
  std::span<const std::uint32_t> words;
  walk::PixelPlace place;
};

class FlowHost {
 public:
  /// At most `limit` rays may be in flight in each cluster. Each packet whose rays are next is counted on
  /// `meter`, which may be null.
  FlowHost(const program::WorkLog& log, const machine::PacketList& packets,
           const machine::MachineConfig& config, std::uint32_t limit, sim::WorkMeter* meter = nullptr);

  /// Whether a camera ray is left for the cluster. Skips pixels without rays. Takes a packet when the
  /// cluster's is used up, so clusters must ask in the order of simulated time, each from its own event.
  [[nodiscard]] bool has_ray(std::uint32_t cluster);
  /// The earliest time at which the cluster's next camera ray may be sent.
  [[nodiscard]] sim::Ticks ready_at(std::uint32_t cluster) const { return ways_[cluster].ready_at; }
  /// Sends the next camera ray at `now`, at least ready_at(), and returns its sample. There must be a ray,
  /// and enter() must have been called for it.
  SentSample send(std::uint32_t cluster, sim::Ticks now);

  /// Whether one more ray may enter the cluster.
  [[nodiscard]] bool has_credit(std::uint32_t cluster) const { return ways_[cluster].in_flight < limit_; }
  /// A ray enters the cluster, from the host or after it was set aside.
  void enter(std::uint32_t cluster) {
    ++ways_[cluster].in_flight;
    most_in_flight_ = std::max(most_in_flight_, ++in_flight_);
  }
  /// A ray has ended and frees its place.
  void leave(std::uint32_t cluster) {
    --ways_[cluster].in_flight;
    --in_flight_;
  }

  /// A contribution arrives at `arrival`.
  void collect(sim::Ticks arrival) {
    ++collected_;
    last_arrival_ = std::max(last_arrival_, arrival);
  }

  [[nodiscard]] std::int64_t sent() const { return statistics_.requests; }
  [[nodiscard]] std::int64_t collected() const { return collected_; }
  [[nodiscard]] std::int64_t in_flight() const { return in_flight_; }
  [[nodiscard]] std::int64_t most_in_flight() const { return most_in_flight_; }
  /// When the last contribution arrived.
  [[nodiscard]] sim::Ticks last_arrival() const { return last_arrival_; }
  /// `requests` is the number of camera rays sent.
  [[nodiscard]] const node::HostStatistics& statistics() const { return statistics_; }

 private:
  struct Way {
    sim::Ticks ready_at = 0;
    std::uint32_t in_flight = 0;
    bool drawn = false;  // has a packet with pixels left
    machine::Packet packet;
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    std::size_t word = 0;  // in the pixel: words before it belong to samples already sent
  };

  const program::WorkLog& log_;
  const machine::PacketList& packets_;
  sim::WorkMeter* meter_;
  std::uint32_t limit_;
  sim::Ticks occupancy_;
  std::uint64_t next_packet_ = 0;
  std::vector<Way> ways_;
  std::int64_t in_flight_ = 0;
  std::int64_t most_in_flight_ = 0;
  std::int64_t collected_ = 0;
  sim::Ticks last_arrival_ = 0;
  node::HostStatistics statistics_;
};

}  // namespace marti::processors::flow
