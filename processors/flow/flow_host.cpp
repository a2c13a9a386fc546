#include "processors/flow/flow_host.h"

#include "processors/program/ray_tree.h"
#include "sim/error.h"

namespace marti::processors::flow {

FlowHost::FlowHost(const program::WorkLog& log, const machine::PacketList& packets,
                   const machine::MachineConfig& config, std::uint32_t limit, sim::WorkMeter* meter)
    : log_(log),
      packets_(packets),
      meter_(meter),
      limit_(limit),
      occupancy_(config.host.clock.cycles(config.host.occupancy_cycles)),
      ways_(config.clusters) {
  for (Way& way : ways_) {
    way.ready_at = config.host.clock.cycles(config.host.latency_cycles);
  }
}

bool FlowHost::has_ray(std::uint32_t cluster) {
  Way& way = ways_[cluster];
  for (;;) {
    if (!way.drawn) {
      if (next_packet_ == packets_.size()) {
        return false;
      }
      count_step(meter_);
      way.packet = packets_[next_packet_++];
      way.x = way.packet.x0;
      way.y = way.packet.y0;
      way.drawn = true;
    }
    for (; way.y != way.packet.y1; ++way.y, way.x = way.packet.x0) {
      for (; way.x != way.packet.x1; ++way.x) {
        if (!log_.pixel(way.x, way.y).empty()) {
          return true;
        }
      }
    }
    way.drawn = false;
  }
}

SentSample FlowHost::send(std::uint32_t cluster, sim::Ticks now) {
  Way& way = ways_[cluster];
  sim::ensure(has_ray(cluster) && way.in_flight > 0 && way.ready_at <= now,
              "the host sends a camera ray too early");
  const std::span<const std::uint32_t> words = log_.pixel(way.x, way.y);
  const SentSample sample = {program::first_sample(log_, words.subspan(way.word)), {way.x, way.y}};
  way.word += sample.words.size();
  if (way.word == words.size()) {
    ++way.x;
    way.word = 0;
  }
  way.ready_at = sim::add_ticks(now, occupancy_);
  ++statistics_.requests;
  statistics_.busy += occupancy_;
  return sample;
}

}  // namespace marti::processors::flow
