// How fast the SystemC model of tests/validation/systemc times a machine, beside the replay of the same one.
//   bench_systemc [SIZE [NODES]] [--json FILE]     default: 256 16
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>

#include "accel/structure.h"
#include "bench/report.h"
#include "processors/cost/cost_model.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/validation/systemc/difference.h"
#include "tests/validation/systemc/simulate.h"

namespace {

using namespace marti;

constexpr int replays = 7;

// Processor time: the model runs once, so other work on the computer must not be counted.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void print(const char* name, double seconds, double references) {
  std::printf("%-28s %8.1f ms %8.2f M/s\n", name, 1e3 * seconds, references / seconds / 1e6);
}

// The machine of bench_replay: 4-way 16 KiB private caches on a split bus.
void run(bench::Report& report, std::uint32_t size, std::uint32_t nodes) {
  const scenes::Scene scene = scenes::make_procedural("teapot:12");
  const auto primitives = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", primitives);
  const processors::program::RenderOptions options{
      .width = size, .height = size, .max_depth = 2, .record = true};
  const processors::program::Frame frame =
      processors::program::render(scene, *primitives, *structure, options);
  processors::machine::MachineConfig machine;
  machine.nodes = nodes;
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost::cost_preset("unit");

  processors::replay::MachineResult result;
  double ahead = 1e300;
  double stepped = 1e300;
  for (int i = 0; i < replays; ++i) {
    double start = now();
    result = processors::replay::replay(*frame.log, machine);
    ahead = std::min(ahead, now() - start);
    start = now();
    result = processors::replay::replay(*frame.log, machine, {.step_by_step = true});
    stepped = std::min(stepped, now() - start);
  }
  const std::array jobs = {oracle::Job{frame.log.get(), &machine}};
  const oracle::Simulation simulation = oracle::simulate(jobs);
  const auto references = static_cast<double>(result.references().references());
  std::printf("teapot:12, %u x %u, depth 2, %u nodes; %.2f million references\n", size, size, nodes,
              references / 1e6);
  print("replay", ahead, references);
  print("replay, every reference", stepped, references);
  print("SystemC", simulation.seconds, references);
  std::printf("SystemC takes %.1f times the replay's time, %.1f times that with an event a reference\n",
              simulation.seconds / ahead, simulation.seconds / stepped);
  const std::size_t differing = oracle::differences(result, simulation.machines[0]).size();
  std::printf("figures that differ: %zu\n", differing);
  sim::ensure(differing == 0, "the replay and the SystemC model find the same figures");
  const double millions = references / 1e6;
  report.add(bench::against("replay, " + std::to_string(nodes) + " nodes", "M refs/s", millions / ahead,
                            "SystemC model", millions / simulation.seconds, bench::Aim{20.0}));
  report.add(bench::against("an event for every reference, " + std::to_string(nodes) + " nodes", "M refs/s",
                            millions / stepped, "SystemC model", millions / simulation.seconds));
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_systemc", argc, argv, [](bench::Report& report, int count, char** values) {
        run(report, count > 1 ? static_cast<std::uint32_t>(std::atoi(values[1])) : 256U,
            count > 2 ? static_cast<std::uint32_t>(std::atoi(values[2])) : 16U);
      });
}
