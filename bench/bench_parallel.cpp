// How much sooner one huge machine is timed by several threads than by one, with equal results.
//   bench_parallel [SIZE [REPEATS [THREADS]]] [--json FILE]     default: 512 3, as many threads as the
//   computer has
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "accel/structure.h"
#include "bench/report.h"
#include "processors/cost/cost_model.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace {

using namespace marti;
using processors::machine::MachineConfig;

// As in bench_replay: 4-way 16 KiB private caches.
MachineConfig machine_of(std::uint32_t clusters, std::uint32_t nodes) {
  MachineConfig machine;
  machine.clusters = clusters;
  machine.nodes = nodes;
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost::cost_preset("unit");
  machine.packets = {2, 2, processors::machine::PacketOrder::scanline};
  return machine;
}

// Each node holds a part of the database, and a mesh connects them.
MachineConfig on_mesh(std::uint32_t nodes) {
  MachineConfig machine = machine_of(1, nodes);
  machine.placement = processors::machine::Placement::distributed;
  return machine;
}

struct Case {
  std::string name;
  MachineConfig machine;
  double aim = 0.0;  // how many times as fast on two threads; 0: none
};

std::vector<Case> cases() {
  return {{"16 clusters of 16 nodes", machine_of(16, 16)},
          {"64 clusters of 64 nodes", machine_of(64, 64), 1.6},
          {"256 clusters of 64 nodes", machine_of(256, 64), 1.6},
          {"1,024 clusters of 64 nodes", machine_of(1024, 64), 1.6},
          {"16,384 nodes on a mesh", on_mesh(16384), 1.6},
          {"65,536 nodes on a mesh", on_mesh(65536), 1.6}};
}

// Seconds as people wait, the least of several, and the result.
std::pair<double, processors::replay::MachineResult> time_replay(
    const processors::program::WorkLog& log, const MachineConfig& machine, int repeats,
    const processors::replay::ReplayOptions& options) {
  std::pair<double, processors::replay::MachineResult> best = {1e300, {}};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    best.second = processors::replay::replay(log, machine, options);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best.first = std::min(best.first, took.count());
  }
  return best;
}

void run(bench::Report& report, std::uint32_t size, int repeats, unsigned threads) {
  const scenes::Scene scene = scenes::make_procedural("teapot:12");
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", triangles);
  const processors::program::RenderOptions frame{
      .width = size, .height = size, .max_depth = 2, .record = true};
  const auto log = processors::program::render(scene, *triangles, *structure, frame, threads).log;
  const auto stripped = processors::walk::StrippedLog::make(*log, machine_of(1, 64));
  std::printf("teapot:12, %u x %u, depth 2, packets of 2 x 2; least of %d, as people wait\n", size, size,
              repeats);
  for (const auto& [name, machine, aim] : cases()) {
    for (const bool walks_stripped : {false, true}) {
      processors::replay::ReplayOptions options;
      options.stripped = walks_stripped ? stripped.get() : nullptr;
      const auto [one, alone] = time_replay(*log, machine, repeats, options);
      options.threads = threads;
      const auto [many, together] = time_replay(*log, machine, repeats, options);
      if (alone.end != together.end || alone.events != together.events || alone.time() != together.time()) {
        throw sim::InternalError(name + ": several threads find another result than one");
      }
      const std::string full = name + (walks_stripped ? ", stripped log" : "");
      std::printf("%-40s one thread %8.1f ms, %u threads %8.1f ms, %5.2f times as fast\n", full.c_str(),
                  1e3 * one, threads, 1e3 * many, one / many);
      report.add(bench::against(full, "ms", 1e3 * one, std::to_string(threads) + " threads", 1e3 * many,
                                aim == 0.0 ? std::nullopt : std::optional(bench::Aim{aim})));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_parallel", argc, argv, [](bench::Report& report, int count, char** values) {
        run(report, count > 1 ? static_cast<std::uint32_t>(std::atoi(values[1])) : 512U,
            std::max(1, count > 2 ? std::atoi(values[2]) : 3),
            count > 3 ? static_cast<unsigned>(std::atoi(values[3])) : std::thread::hardware_concurrency());
      });
}
