// What `marti run --within` costs and how far off it is, beside an exact run, from the configuration to the
// figures: on scenes and machines on which its errors were not measured. What would help is not measured, and
// both replay the log as it was recorded.
//   bench_within [SIZE [TOLERANCE [MACHINES [SEED [SCENE]...]]]]     default: 1024 0.05 16 1, six scenes
// SIZE: of the square image; MACHINES: random ones for each scene, beside two that are always the same.
// SCENE: as for scene.source, a file, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bench/estimates/allowances.h"
#include "processors/cost/cost_model.h"
#include "processors/replay/replay.h"
#include "sim/cpu_time.h"
#include "studies/estimate/within.h"
#include "studies/run/prepared_frame.h"

namespace {

using namespace marti;
using studies::estimate::Figure;

// The machine of configs/marti.toml, with 64 nodes.
processors::machine::MachineConfig default_machine() {
  processors::machine::MachineConfig machine;
  machine.nodes = 64;
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost::cost_preset("unit");
  return machine;
}

processors::machine::MachineConfig random_machine(std::mt19937_64& random) {
  const auto one_of = [&](auto... values) {
    const std::array all{values...};
    return all[random() % all.size()];
  };
  processors::machine::MachineConfig machine = default_machine();
  machine.nodes = one_of(1U, 4U, 10U, 16U, 40U, 64U, 100U, 256U, 1024U, 4096U);
  machine.clock = sim::Clock::from_hertz(one_of(25e6, 100e6, 400e6));
  machine.packets.width = one_of(4U, 8U, 16U);
  machine.packets.height = one_of(4U, 8U, 16U);
  machine.packets.order =
      one_of(processors::machine::PacketOrder::scanline, processors::machine::PacketOrder::hilbert);
  machine.cache.cache.line = one_of(16U, 32U, 64U, 128U);
  machine.cache.cache.ways = one_of(1U, 2U, 4U);
  machine.cache.cache.size = std::uint64_t{one_of(2U, 8U, 16U, 64U, 512U)} * 1024;
  machine.interconnect.kind = one_of(memory::InterconnectKind::bus, memory::InterconnectKind::bus,
                                     memory::InterconnectKind::crossbar, memory::InterconnectKind::ideal);
  machine.cache.cache.replacement =
      one_of(memory::Replacement::lru, memory::Replacement::lru, memory::Replacement::fifo);
  machine.interconnect.width = one_of(4U, 8U, 32U);
  machine.interconnect.clock = sim::Clock::from_hertz(one_of(33e6, 100e6));
  return machine;
}

// Sums over all machines that were estimated.
struct Score {
  int cases = 0;
  std::array<int, studies::estimate::figure_count> covered{};
  std::array<double, studies::estimate::figure_count> worst{};
};

struct Costs {
  double within = 0.0;
  double exact = 0.0;
  double worst = 0.0;
};

void compare(const studies::keys::FrameConfig& frame, const processors::machine::MachineConfig& machine,
             double tolerance, std::uint64_t seed, Score& score, Costs& costs) {
  const processors::machine::MachineConfig one = processors::machine::one_node_of(machine);
  double begin = sim::process_cpu_seconds();
  const studies::run::PreparedFrame whole(frame);
  const studies::run::FunctionalRun run = whole.finish(whole.trace());
  studies::estimate::Estimate truth;
  truth.value = studies::estimate::figures_of(machine, processors::replay::replay(*run.frame.log, machine));
  const double alone =
      machine.nodes == 1
          ? truth.value[Figure::end]
          : studies::estimate::figures_of(one, processors::replay::replay(*run.frame.log, one))[Figure::end];
  truth.value[Figure::speed_up] = alone / truth.value[Figure::end];
  const double exact = sim::process_cpu_seconds() - begin;

  begin = sim::process_cpu_seconds();
  const studies::run::PreparedFrame prepared(frame);
  studies::estimate::SampledFrame sampled = studies::estimate::sampled_frame(prepared);
  const processors::machine::PacketList packets(frame.render.width, frame.render.height, machine.packets);
  const studies::estimate::WithinAnswer answer =
      studies::estimate::estimate_within(sampled, packets, machine, tolerance, seed);
  if (!answer.estimate) {
    const studies::run::FunctionalRun filled = prepared.finish(std::move(sampled).whole());
    (void)processors::replay::replay(*filled.frame.log, machine);
    if (machine.nodes > 1) {
      (void)processors::replay::replay(*filled.frame.log, one);
    }
  }
  const double within = sim::process_cpu_seconds() - begin;
  costs.within += within;
  costs.exact += exact;
  costs.worst = std::max(costs.worst, within / exact);
  std::printf("%5u nodes %4u KiB %3u B lines, bus %5.1f %%: %5.2f s exact, within %.3f of it, ",
              machine.nodes, static_cast<unsigned>(machine.cache.cache.size / 1024), machine.cache.cache.line,
              100.0 * truth.value[Figure::use], exact, within / exact);
  if (!answer.estimate) {
    std::printf("exact: %s\n", answer.reason.c_str());
    std::fflush(stdout);
    return;
  }
  const studies::estimate::Estimate& found = answer.estimate->sampled.machine;
  ++score.cases;
  for (std::size_t i = 0; i < studies::estimate::figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    const double error = std::abs(bench::error_of(figure, found.value[figure], truth.value[figure]));
    score.covered[i] += error <= found.half_width[figure] + 1e-12 ? 1 : 0;
    score.worst[i] = std::max(score.worst[i], error);
    std::printf("%s %.1f of %.1f %%, ", std::string(studies::estimate::figure_names[i]).c_str(),
                100.0 * error, 100.0 * found.half_width[figure]);
  }
  std::printf("%.1f %% traced\n", 100.0 * answer.estimate->traced.pixels);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const auto side = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 1024);
  const double tolerance = argc > 2 ? std::atof(argv[2]) : 0.05;
  const int machines = argc > 3 ? std::atoi(argv[3]) : 16;
  std::mt19937_64 random(argc > 4 ? static_cast<std::uint64_t>(std::atoi(argv[4])) : 1);
  Score score;
  Costs all;
  std::uint64_t seed = 0;
  constexpr std::array all_scenes = {"teapot:12", "gears:4", "tree:8", "mount:6", "rings:5", "balls:4"};
  const std::vector<std::string> scenes =
      argc > 5 ? std::vector<std::string>(argv + 5, argv + argc)
               : std::vector<std::string>(all_scenes.begin(), all_scenes.end());
  for (const std::string& scene : scenes) {
    studies::keys::FrameConfig frame;
    frame.scene = scene;
    frame.structure = "octree";
    frame.render.width = side;
    frame.render.height = side;
    frame.render.max_depth = 2;
    frame.memory = sim::MemoryBudget(std::uint64_t{1} << 33U);
    std::printf("%s, %u x %u, within %g %%\n", scene.c_str(), side, side, 100.0 * tolerance);
    processors::machine::MachineConfig full = default_machine();
    full.cache.cache = {.size = 4096, .line = 32, .ways = 1};
    for (const processors::machine::MachineConfig& machine : {default_machine(), full}) {
      compare(frame, machine, tolerance, ++seed, score, all);
    }
    for (int i = 0; i < machines; ++i) {
      compare(frame, random_machine(random), tolerance, ++seed, score, all);
    }
  }
  std::printf("\n%d of them estimated; processor time of all: %.3f of exact, of the worst: %.3f\n",
              score.cases, all.within / all.exact, all.worst);
  for (std::size_t i = 0; i < studies::estimate::figure_count && score.cases > 0; ++i) {
    std::printf("%-9s in the interval in %5.1f %% of cases, worst error %.1f %%\n",
                std::string(studies::estimate::figure_names[i]).c_str(),
                100.0 * score.covered[i] / score.cases, 100.0 * score.worst[i]);
  }
  return 0;
}
