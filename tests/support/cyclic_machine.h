// A machine whose times are known in closed form.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "processors/cost/step_time.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "sim/time.h"

namespace marti::tests {

/// D/D/1//N: every node computes for `think`, then reads from a held bus for `service`, `reads` times. A node
/// has one pixel; it shades `reads` points and then adds `lights` lights, which takes `after`. If `lights` is
/// 0, so many are taken that no pixel is written before the last node's reads are over.
struct Cyclic {
  Cyclic(std::uint32_t nodes, std::uint32_t reads, std::int64_t bank_cycles, std::size_t lights = 0) {
    machine.nodes = nodes;
    machine.operations = {1, 1, 1, 1, 1, 1, 1, 1};
    machine.cache.organisation = processors::machine::CacheOrganisation::none;
    machine.interconnect.mode = memory::BusMode::held;
    machine.banks.access_cycles = bank_cycles;
    machine.banks.busy_cycles = bank_cycles;
    machine.layout.material_bytes = 8;
    machine.packets = {1, 1, processors::machine::PacketOrder::scanline};
    machine.host.assignment = processors::machine::Assignment::interleaved;
    log.width = nodes;
    log.height = 1;
    log.topology.nodes.push_back({0, 0, 1, true});
    log.primitives = 1;
    log.materials = 1;
    log.lights = 1;
    log.texture_begin = {0};
    const processors::cost::StepTicks ticks = processors::cost::step_ticks(machine, log);
    think = ticks.shade;
    service = machine.interconnect.clock.cycles(2) + machine.banks.clock.cycles(bank_cycles);
    if (lights == 0) {
      lights = static_cast<std::size_t>(nodes * service / ticks.light + 1);
    }
    after = static_cast<sim::Ticks>(lights) * ticks.light + ticks.pixel;
    log.rows.resize(1);
    for (std::uint32_t node = 0; node < nodes; ++node) {
      log.rows[0].begin.push_back(static_cast<std::uint32_t>(log.rows[0].words.size()));
      log.rows[0].words.insert(log.rows[0].words.end(), reads,
                               processors::program::make_word(processors::program::Step::shade, 0));
      log.rows[0].words.insert(log.rows[0].words.end(), lights,
                               processors::program::make_word(processors::program::Step::light, 0));
    }
    log.rows[0].begin.push_back(static_cast<std::uint32_t>(log.rows[0].words.size()));
  }

  /// What a read waits for the bus once the first round is over: either the bus is free in time, or every
  /// read waits until the bus has served all other nodes.
  [[nodiscard]] sim::Ticks wait_of_later_rounds() const {
    return std::max<sim::Ticks>(0, (log.width - 1) * service - think);
  }

  /// By how many ticks all waits, finishes and sums of a replay differ from their closed forms; 0 is right.
  [[nodiscard]] sim::Ticks off(const processors::replay::MachineResult& result, std::int64_t reads) const {
    const sim::Ticks n = log.width;
    const sim::Ticks each = wait_of_later_rounds();
    sim::Ticks sum = 0;
    for (std::uint32_t i = 0; i < log.width; ++i) {
      // All nodes first ask at the same time, so node i waits for i others.
      const sim::Ticks wait = i * service + (reads - 1) * each;
      const processors::cost::NodeStatistics& node = result.nodes[i];
      sum += std::llabs(node.time[static_cast<std::size_t>(processors::cost::Activity::interconnect_wait)] -
                        wait) +
             std::llabs(node.finish - (reads * (think + service) + wait + after));
    }
    return sum + std::llabs(sim::ticks_of(result.clusters[0].interconnect.waits.sum) -
                            (n * (n - 1) / 2 * service + n * (reads - 1) * each));
  }

  processors::program::WorkLog log;
  processors::machine::MachineConfig machine;
  sim::Ticks think = 0;
  sim::Ticks service = 0;  ///< of a read, and of the write of a pixel
  sim::Ticks after = 0;
};

}  // namespace marti::tests
