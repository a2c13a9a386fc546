#include "processors/node/host.h"

#include <algorithm>

namespace marti::processors::node {

Host::Host(const machine::HostConfig& config, std::uint64_t packets, std::uint32_t nodes,
           sim::WorkMeter* meter)
    : config_(config),
      meter_(meter),
      packets_(packets),
      nodes_(nodes),
      taken_(config.assignment == machine::Assignment::dynamic ? 0 : nodes),
      latency_(config.clock.cycles(config.latency_cycles)),
      occupancy_(config.clock.cycles(config.occupancy_cycles)) {}

std::optional<Grant> Host::next(std::uint32_t node, sim::Ticks now) {
  if (config_.assignment == machine::Assignment::interleaved) {
    const std::uint64_t packet = node + taken_[node] * nodes_;
    if (packet >= packets_) {
      return std::nullopt;
    }
    ++taken_[node];
    count_step(meter_);
    return Grant{packet, now};
  }
  if (config_.assignment == machine::Assignment::blocks) {
    const std::uint64_t packet = packets_ * node / nodes_ + taken_[node];
    if (packet >= packets_ * (node + 1) / nodes_) {
      return std::nullopt;
    }
    ++taken_[node];
    count_step(meter_);
    return Grant{packet, now};
  }
  ++statistics_.requests;
  if (handed_out_ == packets_) {
    return std::nullopt;
  }
  count_step(meter_);
  const sim::Ticks begin = std::max(now, free_at_);
  free_at_ = sim::add_ticks(begin, occupancy_);
  statistics_.busy += occupancy_;
  return Grant{handed_out_++, sim::add_ticks(begin, latency_)};
}

}  // namespace marti::processors::node
