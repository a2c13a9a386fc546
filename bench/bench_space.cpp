// How fast the space scheme is timed: exact replay of one frame on one host core, beside the native render of
// the same frame by the same tracer.
//   bench_space [SIZE [REPEATS]]     default: 512 5
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "processors/replay.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace {

using namespace marti;

// Processor time: others may be at work on the host.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// 4-way 16 KiB caches before each node's memory; a mesh between the nodes.
processors::MachineConfig machine_of(std::uint32_t nodes) {
  processors::MachineConfig machine;
  machine.scheme = processors::Scheme::space;
  machine.nodes = nodes;
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost_preset("unit");
  return machine;
}

void measure(const char* name, const processors::WorkLog& log, const processors::MachineConfig& machine,
             int repeats, double render) {
  double best = 1e300;
  processors::MachineResult result;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    const double start = now();
    result = processors::replay(log, machine);
    best = repeat == 0 ? best : std::min(best, now() - start);
  }
  double messages = 0.0;
  double hops = 0.0;
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    messages += static_cast<double>(network.messages);
    hops += static_cast<double>(network.hops);
  }
  const auto references = static_cast<double>(result.references().references());
  std::printf(
      "%-34s %8.1f ms %7.1f M references/s %6.2f M messages/s %5.2f events a message %5.1f hops %6.3f x "
      "render, "
      "%zu host bytes a node\n",
      name, 1e3 * best, references / best / 1e6, messages / best / 1e6,
      static_cast<double>(result.events) / messages, hops / messages, best / render,
      result.host_bytes_per_node);
}

void run(std::uint32_t size, int repeats) {
  const scenes::Scene scene = scenes::make_procedural("teapot:12");
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", triangles);
  processors::RenderOptions options{.width = size, .height = size, .max_depth = 2};
  double render = 1e300;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    const double start = now();
    (void)processors::render(scene, *triangles, *structure, options, 1);
    render = repeat == 0 ? render : std::min(render, now() - start);
  }
  options.record = true;
  const processors::Frame frame = processors::render(scene, *triangles, *structure, options, 1);
  std::printf("teapot:12, %u x %u, depth 2; native render on one thread %.1f ms (best of %d)\n", size, size,
              1e3 * render, repeats);
  measure("64 nodes, scatter, level 4", *frame.log, machine_of(64), repeats, render);
  processors::MachineConfig other = machine_of(64);
  other.space.policy = processors::RegionPolicy::sampled;
  measure("64 nodes, sampled, level 4", *frame.log, other, repeats, render);
  other = machine_of(64);
  other.space.policy = processors::RegionPolicy::blocks;
  measure("64 nodes, blocks, level 4", *frame.log, other, repeats, render);
  other = machine_of(64);
  other.space.level = 6;
  measure("64 nodes, scatter, level 6", *frame.log, other, repeats, render);
  other = machine_of(64);
  other.network.kind = memory::NetworkKind::crossbar;
  measure("64 nodes, scatter, crossbar", *frame.log, other, repeats, render);
  measure("1 node", *frame.log, machine_of(1), repeats, render);
  measure("8 nodes", *frame.log, machine_of(8), repeats, render);
  other = machine_of(1024);
  other.space.level = 6;
  measure("1,024 nodes, scatter, level 6", *frame.log, other, repeats, render);
  other = machine_of(65536);
  other.space.level = 10;
  measure("65,536 nodes, scatter, level 10", *frame.log, other, 1, render);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? static_cast<std::uint32_t>(std::atoi(argv[1])) : 512U,
        std::max(1, argc > 2 ? std::atoi(argv[2]) : 5));
  } catch (const sim::UserError& error) {
    std::fprintf(stderr, "bench_space: %s\n", error.what());
    return 2;
  }
  return 0;
}
