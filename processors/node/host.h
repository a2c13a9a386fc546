// The host: gives packets to the nodes of all clusters.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "processors/machine/host_config.h"
#include "processors/machine/packets.h"
#include "sim/statistics.h"
#include "sim/time.h"
#include "sim/work_meter.h"

namespace marti::processors::node {

/// A packet and when its node may begin it.
struct Grant {
  std::uint64_t packet = 0;
  sim::Ticks start = 0;
};

struct HostStatistics {
  std::int64_t requests = 0;  ///< by dynamic assignment, those that found no packet left included
  sim::Sum busy = 0;

  static constexpr auto counters() {
    using C = sim::Counter<HostStatistics>;
    return std::array{C{"requests", "1",
                        "requests of free nodes, those that found no packet left included; where rays move, "
                        "camera rays sent",
                        &HostStatistics::requests},
                      C{"busy", "ps", "time that these kept the host", &HostStatistics::busy}};
  }
};
static_assert(sim::declares_every_member<HostStatistics>());

/// Requests must come in the order of simulated time.
class Host {
 public:
  /// Each packet that is granted is counted on `meter`, which may be null.
  Host(const machine::HostConfig& config, std::uint64_t packets, std::uint32_t nodes,
       sim::WorkMeter* meter = nullptr);

  /// Grants node `node`, free at `now`, its next packet; std::nullopt when none is left for it.
  std::optional<Grant> next(std::uint32_t node, sim::Ticks now);

  [[nodiscard]] const HostStatistics& statistics() const { return statistics_; }

 private:
  machine::HostConfig config_;
  sim::WorkMeter* meter_;
  std::uint64_t packets_;
  std::uint64_t nodes_;
  std::uint64_t handed_out_ = 0;      // dynamic
  std::vector<std::uint32_t> taken_;  // static: number of packets that each node has taken
  sim::Ticks latency_;
  sim::Ticks occupancy_;
  sim::Ticks free_at_ = 0;
  HostStatistics statistics_;
};

}  // namespace marti::processors::node
