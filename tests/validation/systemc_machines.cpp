#include "tests/validation/systemc_machines.h"

#include <array>
#include <memory>
#include <utility>

#include "accel/structure.h"
#include "processors/cost/cost_model.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/support/random_machine.h"
#include "tests/validation/systemc/machine.h"

namespace marti::oracle {

namespace {

using processors::machine::MachineConfig;

bool is_modelled(const MachineConfig& config) {
  try {
    refuse_what_is_not_modelled(config);
  } catch (const sim::InternalError&) {
    return false;
  }
  return true;
}

MachineConfig random_modelled_machine(test::Random& random) {
  for (;;) {
    const MachineConfig config = test::random_machine(random);
    if (is_modelled(config)) {
      return config;
    }
  }
}

// Draws the settings that random_machine() leaves at their defaults.
void vary_the_rest(test::Random& random, MachineConfig& config) {
  const auto bytes = [&random](std::int64_t most) {
    return static_cast<std::uint32_t>(test::pick(random, 1, most));
  };
  config.word_bytes = bytes(8);
  config.layout.entry_bytes = bytes(8);
  config.layout.material_bytes = bytes(100);
  config.layout.texel_bytes = bytes(16);
  config.layout.pixel_bytes = bytes(40);
  config.layout.record_alignment = 1U << bytes(6);
  config.layout.section_alignment = 1U << bytes(12);
  config.cache.cache.seed = random();
  config.local.width = bytes(16);
  config.local.cycles_per_beat = test::pick(random, 0, 2);
}

void make_times_equal(test::Random& random, MachineConfig& config) {
  const sim::Clock clock = sim::Clock::from_period(test::pick(random, 1, 2) * 5);
  config.clock = config.interconnect.clock = config.banks.clock = config.host.clock = config.local.clock =
      clock;
  config.operations = {0, 0, 0, 0, 0, test::pick(random, 0, 1), 0, 0};
  config.cache.hit_cycles = test::pick(random, 0, 1);
  config.interconnect.width = 16;
  config.interconnect.cycles_per_beat = test::pick(random, 0, 1);
  config.interconnect.latency_cycles = test::pick(random, 0, 1);
  config.interconnect.address_cycles = test::pick(random, 0, 1);
  config.banks.access_cycles = test::pick(random, 0, 2);
  config.banks.busy_cycles = test::pick(random, 0, 2);
  config.host.latency_cycles = test::pick(random, 0, 1);
  config.host.occupancy_cycles = test::pick(random, 0, 1);
}

void make_queues_long(test::Random& random, MachineConfig& config) {
  config.placement = processors::machine::Placement::shared;
  const std::uint32_t ways = config.cache.cache.ways == memory::full_ways ? 2 : config.cache.cache.ways;
  config.cache.cache.size = std::uint64_t{config.cache.cache.line} * ways;
  config.cache.split_sizes.fill(config.cache.cache.size);
  config.interconnect.cycles_per_beat = test::pick(random, 1, 3);
  config.banks.count = static_cast<std::uint32_t>(test::pick(random, 1, 2));
  config.banks.access_cycles = test::pick(random, 4, 12);
  config.banks.busy_cycles = test::pick(random, 4, 12);
  config.host.occupancy_cycles = test::pick(random, 10, 40);
}

// Pixels that come faster than they can be written, over banks of different load.
void make_writes_many(test::Random& random, MachineConfig& config) {
  config.operations = {0, 0, 0, 0, 0, 1, 0, 0};
  config.clock = sim::Clock::from_period(1);
  config.write_buffer = static_cast<std::uint32_t>(test::pick(random, 1, 4));
  config.layout.pixel_bytes = static_cast<std::uint32_t>(test::pick(random, 1, 8));
  config.packets.width = static_cast<std::uint32_t>(test::pick(random, 1, 3));
  config.packets.height = static_cast<std::uint32_t>(test::pick(random, 1, 2));
  config.interconnect.clock = sim::Clock::from_period(test::pick(random, 1, 5));
  config.interconnect.width = 8;
  config.banks.count = static_cast<std::uint32_t>(test::pick(random, 2, 5));
  config.banks.interleave = 4;
  config.banks.clock = sim::Clock::from_period(test::pick(random, 20, 100));
  config.banks.access_cycles = test::pick(random, 1, 12);
  config.banks.busy_cycles = test::pick(random, 1, 12);
}

}  // namespace

std::deque<ComparedMachine> random_machines(std::uint64_t seed, std::uint32_t count) {
  std::deque<ComparedMachine> machines;
  for (std::uint64_t i = 0; i < count; ++i) {
    test::Random random(seed + i);
    const auto width = static_cast<std::uint32_t>(test::pick(random, 1, 12));
    const auto height = static_cast<std::uint32_t>(test::pick(random, 1, 12));
    const std::uint32_t words = i % 4 == 3 ? 1 : 25;
    machines.push_back({"seed " + std::to_string(seed + i),
                        test::random_log(random, width, height, words, true),
                        random_modelled_machine(random)});
    MachineConfig& config = machines.back().config;
    vary_the_rest(random, config);
    if (i % 4 == 1) {
      make_times_equal(random, config);
    } else if (i % 4 == 2) {
      make_queues_long(random, config);
    } else if (i % 4 == 3) {
      make_writes_many(random, config);
    }
  }
  return machines;
}

std::deque<ComparedMachine> machines_of_real_frames() {
  struct Real {
    const char* scene;
    const char* structure;
    bool mailboxes;
    double cut;
  };
  constexpr std::array frames = {Real{"teapot:3", "octree", false, 0.0}, Real{"balls:2", "bsp", true, 0.0},
                                 Real{"rings:2", "grid", true, 0.0}, Real{"tree:3", "octree", false, 0.0},
                                 Real{"tetra:4", "octree", false, 4.0}};
  std::deque<ComparedMachine> machines;
  for (const Real& frame : frames) {
    const scenes::Scene scene = scenes::make_procedural(frame.scene);
    const auto primitives = std::make_shared<const accel::TriangleSet>(scene);
    const auto structure = accel::make_structure(frame.structure, primitives);
    processors::program::RenderOptions options{.width = 20, .height = 16, .max_depth = 3, .record = true};
    options.mailboxes = frame.mailboxes;
    options.voxel_cut = frame.cut;
    const auto log = processors::program::render(scene, *primitives, *structure, options, 1).log;
    MachineConfig config;
    config.clusters = machines.size() % 2 == 0 ? 1 : 2;
    config.nodes = 12;
    config.operations = processors::cost::cost_preset("unit");
    config.packets = {2, 2, processors::machine::PacketOrder::hilbert};
    config.cache.cache.size = 4096;
    config.interconnect.kind =
        machines.size() % 3 == 2 ? memory::InterconnectKind::crossbar : memory::InterconnectKind::bus;
    config.interconnect.mode = machines.size() % 2 == 0 ? memory::BusMode::split : memory::BusMode::held;
    machines.push_back({frame.scene, *log, config});
  }
  return machines;
}

}  // namespace marti::oracle
