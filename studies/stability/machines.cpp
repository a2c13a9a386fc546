#include "studies/stability/machines.h"

#include <array>
#include <memory>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"

namespace marti::studies::stability {

namespace {

using processors::machine::MachineConfig;
using processors::machine::Scheme;
using processors::replay::MachineResult;

std::array<sim::Clock*, 6> clocks_of(MachineConfig& machine) {
  return {&machine.clock,       &machine.local.clock, &machine.interconnect.clock,
          &machine.banks.clock, &machine.host.clock,  &machine.network.clock};
}

}  // namespace

const processors::program::WorkLog& small_log() {
  static const std::shared_ptr<const processors::program::WorkLog> log = [] {
    const scenes::Scene scene = scenes::make_procedural("balls:2");
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const auto structure = accel::make_structure("octree", triangles);
    processors::program::RenderOptions options;
    options.width = 24;
    options.height = 16;
    options.max_depth = 3;
    options.record = true;
    return processors::program::render(scene, *triangles, *structure, options).log;
  }();
  return *log;
}

std::vector<NamedTiming> machines_of_every_kind(processors::machine::Assignment assignment) {
  MachineConfig base;
  base.nodes = 6;
  base.packets = {2, 3, processors::machine::PacketOrder::hilbert};
  base.cache.cache.size = 2048;
  base.cache.cache.ways = 2;
  base.host.assignment = assignment;
  const std::array<sim::Ticks, 6> periods{3, 2, 5, 7, 4, 6};
  const auto clocks = clocks_of(base);
  for (std::size_t k = 0; k < clocks.size(); ++k) {
    *clocks[k] = sim::Clock::from_period(periods[k]);
  }
  std::vector<NamedTiming> all;
  const auto add = [&](std::string name, const auto& change) {
    MachineConfig machine = base;
    change(machine);
    all.push_back({std::move(name), machine});
  };
  add("split bus", [](MachineConfig&) {});
  add("held bus", [](MachineConfig& m) { m.interconnect.mode = memory::BusMode::held; });
  add("bus by priority",
      [](MachineConfig& m) { m.interconnect.arbitration = memory::Arbitration::fixed_priority; });
  add("crossbar", [](MachineConfig& m) { m.interconnect.kind = memory::InterconnectKind::crossbar; });
  add("ideal interconnect", [](MachineConfig& m) { m.interconnect.kind = memory::InterconnectKind::ideal; });
  add("no cache",
      [](MachineConfig& m) { m.cache.organisation = processors::machine::CacheOrganisation::none; });
  add("replicated", [](MachineConfig& m) { m.placement = processors::machine::Placement::replicated; });
  add("distributed", [](MachineConfig& m) { m.placement = processors::machine::Placement::distributed; });
  add("two clusters", [](MachineConfig& m) {
    m.clusters = 2;
    m.nodes = 3;
  });
  add("four contexts", [](MachineConfig& m) { m.contexts = 4; });
  add("tree built meanwhile", [](MachineConfig& m) {
    m.build.sharing = processors::machine::Sharing::shared;
    m.build.initial = processors::machine::InitialTree::level;
  });
  add("pipeline", [](MachineConfig& m) {
    m.scheme = Scheme::pipeline;
    m.pipeline = processors::machine::default_stages(m.nodes);
  });
  add("space", [](MachineConfig& m) { m.scheme = Scheme::space; });
  return all;
}

bool stretch(MachineConfig& machine, std::int64_t factor) {
  for (sim::Clock* clock : clocks_of(machine)) {
    sim::Ticks period = 0;
    if (__builtin_mul_overflow(clock->period(), factor, &period)) {
      return false;
    }
    *clock = sim::Clock::from_period(period);
  }
  return true;
}

bool is_stretched(const MachineResult& short_one, const MachineResult& long_one, std::int64_t factor) {
  if (short_one.nodes.size() != long_one.nodes.size() || short_one.events != long_one.events ||
      short_one.end * factor != long_one.end) {
    return false;
  }
  for (std::size_t k = 0; k < short_one.nodes.size(); ++k) {
    const processors::cost::NodeStatistics& a = short_one.nodes[k];
    const processors::cost::NodeStatistics& b = long_one.nodes[k];
    if (a.finish * factor != b.finish || a.packets != b.packets || a.references.hits != b.references.hits ||
        a.references.misses != b.references.misses) {
      return false;
    }
    for (std::size_t activity = 0; activity < processors::cost::activities; ++activity) {
      if (a.time[activity] * factor != b.time[activity]) {
        return false;
      }
    }
  }
  for (std::size_t c = 0; c < short_one.clusters.size(); ++c) {
    const memory::InterconnectStatistics& a = short_one.clusters[c].interconnect;
    const memory::InterconnectStatistics& b = long_one.clusters[c].interconnect;
    if (a.busy * factor != b.busy || a.waits.sum * factor != b.waits.sum ||
        a.waits.max * factor != b.waits.max || a.reads != b.reads || a.bytes != b.bytes) {
      return false;
    }
  }
  return true;
}

void take_all_time_away(MachineConfig& machine) {
  machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
  machine.switch_cycles = 0;
  machine.cache.hit_cycles = 0;
  machine.local.access_cycles = 0;
  machine.local.cycles_per_beat = 0;
  machine.interconnect.cycles_per_beat = 0;
  machine.interconnect.address_cycles = 0;
  machine.interconnect.latency_cycles = 0;
  machine.banks.access_cycles = 0;
  machine.banks.busy_cycles = 0;
  machine.host.latency_cycles = 0;
  machine.host.occupancy_cycles = 0;
  machine.network.cycles_per_beat = 0;
  machine.network.hop_cycles = 0;
  machine.messages.send_cycles = 0;
  machine.messages.receive_cycles = 0;
}

bool same_references(const MachineResult& a, const MachineResult& b) {
  bool same = a.nodes.size() == b.nodes.size();
  for (std::size_t k = 0; same && k < a.nodes.size(); ++k) {
    same = a.nodes[k].references.hits == b.nodes[k].references.hits &&
           a.nodes[k].references.misses == b.nodes[k].references.misses;
  }
  return same;
}

}  // namespace marti::studies::stability
