// How fast machines are timed: exact replay of one frame on one host core, beside the native render of the
// same frame by the same tracer.
//   bench_replay [SIZE [REPEATS]] [--json FILE]     default: 512 7
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "accel/structure.h"
#include "bench/report.h"
#include "memory/dram_presets.h"
#include "processors/cost/cost_model.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace {

using namespace marti;

// Processor time of this process, which other programs on the computer do not lengthen much.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// The machine that is timed: 4-way 16 KiB private caches on a split bus that 64 nodes nearly fill.
processors::machine::MachineConfig machine_of(std::uint32_t nodes, std::uint32_t packet) {
  processors::machine::MachineConfig machine;
  machine.nodes = nodes;
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost::cost_preset("unit");
  machine.packets = {packet, packet, processors::machine::PacketOrder::scanline};
  return machine;
}

struct Timing {
  double seconds = 0.0;
  double references = 0.0;
  double misses = 0.0;
  double events = 0.0;
  double bus = 0.0;
  std::size_t bytes_per_node = 0;
};

// Timed with the stripped log if there is one.
Timing time_replay(const processors::program::WorkLog& log, const processors::machine::MachineConfig& machine,
                   int repeats, const processors::walk::StrippedLog* stripped = nullptr) {
  processors::replay::ReplayOptions options;
  options.stripped = stripped;
  Timing best;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    const double start = now();
    const processors::replay::MachineResult result = processors::replay::replay(log, machine, options);
    const double took = now() - start;
    if (repeat == 1 || (repeat > 1 && took < best.seconds)) {
      best.seconds = took;
    }
    best.references = static_cast<double>(result.references().references());
    best.misses = static_cast<double>(result.references().all_misses());
    best.events = static_cast<double>(result.events);
    const memory::InterconnectStatistics& links = result.clusters[0].interconnect;
    best.bus =
        static_cast<double>(links.busy) / static_cast<double>(result.end) / static_cast<double>(links.links);
    best.bytes_per_node = result.host_bytes_per_node;
  }
  return best;
}

void print(const char* name, const Timing& t, double render, double per_reference_of_64) {
  const double nanoseconds = 1e9 * t.seconds / t.references;
  std::printf("%-28s %8.1f ms %8.1f M/s %7.2f ns %6.2f %% miss %6.1f %% bus %7.3f x render", name,
              1e3 * t.seconds, t.references / t.seconds / 1e6, nanoseconds, 100.0 * t.misses / t.references,
              100.0 * t.bus, t.seconds / render);
  if (per_reference_of_64 > 0.0) {
    std::printf(" %6.2f x 64", nanoseconds / per_reference_of_64);
  }
  std::printf("\n");
}

// The least time of stripping `log` on one thread for each of `ways`, and the logs.
double time_stripping(const processors::program::WorkLog& log,
                      const processors::machine::MachineConfig& machine, std::span<const std::uint32_t> ways,
                      int repeats,
                      std::vector<std::shared_ptr<const processors::walk::StrippedLog>>& stripped) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  double least = 1e300;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    stripped.clear();
    const double start = now();
    stripped = processors::walk::StrippedLog::make(log, machine, ways);
    least = repeat == 0 ? least : std::min(least, now() - start);
  }
  return least;
}

// Machines that share stripped logs, beside the native render.
void run_stripped(bench::Report& report, const processors::program::WorkLog& log, double render,
                  int repeats) {
  constexpr std::array<std::uint32_t, 4> ways = {1, 2, 4, 8};
  std::vector<std::shared_ptr<const processors::walk::StrippedLog>> stripped;
  processors::machine::MachineConfig machine = machine_of(64, 8);
  const auto add = [&](const char* name, double seconds, double aim) {
    report.add(
        bench::against(name, "ms", 1e3 * seconds, "native render", 1e3 * render, bench::Aim{aim, false}));
  };
  const double all = time_stripping(log, machine, ways, repeats, stripped);
  std::printf("stripping for 1, 2, 4 and 8 ways on one thread %8.1f ms %7.3f x render\n", 1e3 * all,
              all / render);
  add("stripping for 1, 2, 4 and 8 ways, one thread", all, 1.0);
  const double one = time_stripping(log, machine, std::span(ways).subspan(2, 1), repeats, stripped);
  std::printf("stripping for 4 ways on one thread %8.1f ms %7.3f x render; %.1f MB, 1 of %.1f references\n",
              1e3 * one, one / render, static_cast<double>(stripped[0]->bytes_of_words()) / 1e6,
              static_cast<double>(processors::replay::replay(log, machine).references().references()) /
                  static_cast<double>(stripped[0]->references()));
  add("stripping for 4 ways, one thread", one, 1.0);
  for (const auto& [name, nodes, aim] :
       {std::tuple{"1 node, stripped log", 1U, 0.11}, std::tuple{"64 nodes, stripped log", 64U, 0.30},
        std::tuple{"1,024 nodes, stripped log", 1024U, 0.5}}) {
    machine.nodes = nodes;
    const Timing timing = time_replay(log, machine, repeats, stripped[0].get());
    print(name, timing, render, 0.0);
    add(name, timing.seconds, aim);
  }
  processors::machine::MachineConfig small = machine_of(64, 8);
  small.cache.cache.size = 4096;
  small.cache.cache.ways = 1;
  const double making = time_stripping(log, small, std::span(ways).subspan(0, 1), repeats, stripped);
  const Timing timing = time_replay(log, small, repeats, stripped[0].get());
  print("64 nodes, 4 KiB, 1 way", time_replay(log, small, repeats), render, 0.0);
  print("the same, stripped log", timing, render, 0.0);
  std::printf("  stripped in %.1f ms, %.3f x render\n", 1e3 * making, making / render);
  add("64 nodes, 4 KiB, 1 way, stripped log", timing.seconds, 3.0);
}

// 65,536 nodes, each with one packet of 2 x 2 pixels, beside 64 nodes with such packets.
void run_large(bench::Report& report, const processors::program::WorkLog& log, double render, int repeats) {
  const auto stripped = processors::walk::StrippedLog::make(log, machine_of(64, 2));
  for (const bool distributed : {false, true}) {
    for (const bool walks_stripped : {false, true}) {
      const std::string name =
          std::string(distributed ? ", distributed" : "") + (walks_stripped ? ", stripped" : "");
      const auto time = [&](std::uint32_t nodes) {
        processors::machine::MachineConfig machine = machine_of(nodes, 2);
        machine.placement = distributed ? processors::machine::Placement::distributed
                                        : processors::machine::Placement::shared;
        return time_replay(log, machine, repeats, walks_stripped ? stripped.get() : nullptr);
      };
      const auto nanoseconds = [](const Timing& timing) { return 1e9 * timing.seconds / timing.references; };
      const Timing few = time(64);
      const Timing many = time(65536);
      print(("64 nodes, 2x2" + name).c_str(), few, render, 0.0);
      print(("65,536, 2x2" + name).c_str(), many, render, nanoseconds(few));
      report.add(bench::against("a reference of 65,536 nodes" + name, "ns", nanoseconds(many),
                                "of 64, same packets", nanoseconds(few),
                                bench::Aim{distributed ? 4.0 : 3.0, false}));
      if (!distributed && !walks_stripped) {
        report.add({"a simulated node beside its tags", "B", static_cast<double>(many.bytes_per_node)});
      }
    }
  }
}

// DRAM beside banks of fixed time: behind a slow bus, where it is nearly idle, and behind a fast crossbar,
// where accesses queue.
void run_dram(bench::Report& report, const processors::program::WorkLog& log, double render, int repeats) {
  for (const bool crossbar : {false, true}) {
    processors::machine::MachineConfig machine = machine_of(64, 8);
    const std::string behind = crossbar ? "crossbar" : "bus";
    if (crossbar) {
      machine.clock = sim::Clock::from_hertz(2e9);
      machine.interconnect.kind = memory::InterconnectKind::crossbar;
      machine.interconnect.clock = sim::Clock::from_hertz(2e9);
      machine.banks.count = 2;
      machine.banks.clock = sim::Clock::from_hertz(2e9);
      machine.banks.access_cycles = 60;
    }
    const Timing fixed = time_replay(log, machine, repeats);
    print(("64 nodes, " + behind).c_str(), fixed, render, 0.0);
    machine.banks.dram = memory::dram_preset(0);
    machine.banks.dram->channels = 2;
    for (const memory::DramPolicy policy : {memory::DramPolicy::fcfs, memory::DramPolicy::frfcfs}) {
      machine.banks.dram->policy = policy;
      const std::string name = "64 nodes, " + behind + ", " +
                               std::string(memory::dram_policy_names[static_cast<std::size_t>(policy)]);
      const Timing timing = time_replay(log, machine, repeats);
      print(name.c_str(), timing, render, 0.0);
      const double aim = policy == memory::DramPolicy::fcfs ? 1.5 : 3.0;
      report.add(bench::against(name, "ms", 1e3 * timing.seconds, "banks of fixed time", 1e3 * fixed.seconds,
                                bench::Aim{aim, false}));
    }
  }
}

double time_render(const scenes::Scene& scene, const accel::TriangleSet& triangles,
                   const accel::Structure& structure, const processors::program::RenderOptions& options,
                   int repeats) {
  double render = 1e300;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    const double start = now();
    (void)processors::program::render(scene, triangles, structure, options, 1);
    render = repeat == 0 ? render : std::min(render, now() - start);
  }
  return render;
}

// 64 SIMT nodes with ray-tracing units, whose shader code takes no time, so that the units are busy all
// along.
void run_simt(bench::Report& report, const scenes::Scene& scene,
              const std::shared_ptr<const accel::TriangleSet>& triangles,
              processors::program::RenderOptions options, int repeats) {
  const auto structure = accel::make_structure("bvh", triangles);  // of 8 children
  options.record = false;
  const double render = time_render(scene, *triangles, *structure, options, repeats);
  options.record = true;
  const processors::program::Frame frame =
      processors::program::render(scene, *triangles, *structure, options, 1);
  processors::machine::MachineConfig machine = machine_of(64, 8);
  machine.kind = processors::machine::NodeKind::simt;
  machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
  machine.clock = sim::Clock::from_hertz(1365e6);
  machine.packets = {8, 4, processors::machine::PacketOrder::scanline};
  machine.layout.node_bytes = accel::bvh_record_bytes(accel::BvhNodeKind::eight);
  machine.cache.cache = {64 * 1024, 128, 8};
  machine.cache.hit_cycles = 20;
  machine.simt.sector = 32;
  machine.interconnect.kind = memory::InterconnectKind::crossbar;
  machine.interconnect.clock = machine.clock;
  machine.interconnect.width = 32;
  machine.banks.count = 12;
  machine.banks.clock = machine.clock;
  const Timing timing = time_replay(*frame.log, machine, repeats);
  print("64 SIMT nodes, bvh of 8", timing, render, 0.0);
  report.add(bench::against("64 SIMT nodes, bvh of 8", "ms", 1e3 * timing.seconds, "native render",
                            1e3 * render, bench::Aim{8.0, false}));
}

void run(bench::Report& report, std::uint32_t size, int repeats) {
  const scenes::Scene scene = scenes::make_procedural("teapot:12");
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", triangles);
  processors::program::RenderOptions options{.width = size, .height = size, .max_depth = 2};
  const double render = time_render(scene, *triangles, *structure, options, repeats);
  options.record = true;
  const processors::program::Frame frame =
      processors::program::render(scene, *triangles, *structure, options, 1);
  std::printf("teapot:12, %u x %u, depth 2; native render on one thread %.1f ms (best of %d)\n", size, size,
              1e3 * render, repeats);
  std::printf(
      "one-thread replay: time, references a second, time a reference, miss ratio, bus load, ratios\n");
  const Timing base = time_replay(*frame.log, machine_of(64, 8), repeats);
  print("64 nodes, 8x8 packets", base, render, 0.0);
  const auto rate = [](const Timing& t) { return t.references / t.seconds / 1e6; };
  report.add({"replay of 64 nodes", "M refs/s", rate(base), "", 0.0, std::nullopt, bench::Aim{100.0}});
  report.add(bench::against("replay of 64 nodes", "ms", 1e3 * base.seconds, "native render", 1e3 * render,
                            bench::Aim{1.0, false}));
  const double per_reference = 1e9 * base.seconds / base.references;
  processors::machine::MachineConfig longer = machine_of(64, 8);
  longer.cache.cache.line = 64;
  longer.banks.interleave = 64;
  print("64 nodes, 64-byte lines", time_replay(*frame.log, longer, repeats), render, 0.0);
  processors::machine::MachineConfig dynamic = machine_of(64, 8);
  dynamic.build.sharing = processors::machine::Sharing::shared;
  print("64 nodes, shared building", time_replay(*frame.log, dynamic, repeats), render, 0.0);
  dynamic.build.sharing = processors::machine::Sharing::private_trees;
  print("64 nodes, private building", time_replay(*frame.log, dynamic, repeats), render, 0.0);
  processors::machine::MachineConfig turns = machine_of(64, 8);
  turns.interconnect.arbitration = memory::Arbitration::round_robin;
  print("64 nodes, round robin", time_replay(*frame.log, turns, repeats), render, 0.0);
  processors::machine::MachineConfig spread = machine_of(64, 8);
  spread.placement = processors::machine::Placement::distributed;
  print("64 nodes, distributed", time_replay(*frame.log, spread, repeats), render, 0.0);
  const Timing one = time_replay(*frame.log, machine_of(1, 8), repeats);
  print("1 node, 8x8 packets", one, render, per_reference);
  report.add({"replay of one node", "M refs/s", rate(one), "", 0.0, std::nullopt, bench::Aim{200.0}});
  report.add(bench::against("replay of one node", "ms", 1e3 * one.seconds, "native render", 1e3 * render));
  print("1,024 nodes, 8x8 packets", time_replay(*frame.log, machine_of(1024, 8), repeats), render,
        per_reference);
  print("65,536 nodes, 8x8 packets", time_replay(*frame.log, machine_of(65536, 8), repeats), render,
        per_reference);
  run_large(report, *frame.log, render, repeats);
  std::printf("events a miss %.2f\n", base.events / base.misses);
  run_stripped(report, *frame.log, render, repeats);
  run_dram(report, *frame.log, render, repeats);
  run_simt(report, scene, triangles, options, repeats);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_replay", argc, argv, [](bench::Report& report, int count, char** values) {
        run(report, count > 1 ? static_cast<std::uint32_t>(std::atoi(values[1])) : 512U,
            std::max(1, count > 2 ? std::atoi(values[2]) : 7));
      });
}
