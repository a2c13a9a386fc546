// SIMT machines for closed forms.
#pragma once

#include "processors/machine/machine_config.h"

namespace marti::processors::test {

/// One warp whose lanes compute nothing, records of one line each, a cache that holds them all, and a memory
/// that is as near as the cache.
inline machine::MachineConfig one_warp(std::uint32_t lanes, std::int64_t hit, std::int64_t test) {
  using namespace machine;
  MachineConfig machine;
  machine.nodes = 1;
  machine.kind = NodeKind::simt;
  machine.simt.lanes = lanes;
  machine.simt.warps = 1;
  machine.simt.mshrs = most_mshrs;
  machine.rt.box_cycles = test;
  machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
  machine.pixels = Pixels::collected;
  machine.clock = sim::Clock::from_period(10);
  machine.layout.node_bytes = machine.cache.cache.line;
  machine.cache.cache.size = 1U << 20U;
  machine.cache.hit_cycles = hit;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.clock = machine.clock;
  machine.interconnect.latency_cycles = hit;
  machine.packets = {64, 1, PacketOrder::scanline};
  machine.host.assignment = Assignment::interleaved;
  return machine;
}

}  // namespace marti::processors::test
