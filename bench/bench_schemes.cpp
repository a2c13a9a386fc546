// How fast each parallel scheme is timed: replay of one frame on one host core, beside the native render of
// the same frame by the same tracer. They are timed in turns, in processor time.
//   bench_schemes [SIZE [REPEATS]] [--json FILE]    64 nodes; default: 512 5
//   bench_schemes many SCHEME [SIZE]  65,536 nodes of one scheme: time and the process's peak memory
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "accel/structure.h"
#include "bench/report.h"
#include "processors/cost/cost_model.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace {

using namespace marti;
using processors::machine::Scheme;

// Every scheme, so that a new one is measured too, and what its replay may take at most, in native renders.
constexpr std::array schemes = {Scheme::image, Scheme::pipeline, Scheme::space};
constexpr std::array most_renders = {1.0, 3.5, 1.5};

// Processor time of this process, which other programs on the computer do not lengthen much.
double now() { return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC); }

// bench_replay's machine: 4-way 16 KiB private caches on a split bus, messages over a mesh.
processors::machine::MachineConfig machine_of(Scheme scheme, std::uint32_t nodes) {
  processors::machine::MachineConfig machine;
  machine.scheme = scheme;
  machine.nodes = nodes;
  machine.pipeline = processors::machine::default_stages(nodes);
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost::cost_preset("unit");
  return machine;
}

struct Work {
  scenes::Scene scene = scenes::make_procedural("teapot:12");
  std::shared_ptr<const accel::TriangleSet> triangles = std::make_shared<const accel::TriangleSet>(scene);
  std::unique_ptr<accel::Structure> structure = accel::make_structure("octree", triangles);
  processors::program::RenderOptions options;

  explicit Work(std::uint32_t size) : options{.width = size, .height = size, .max_depth = 2} {}
  [[nodiscard]] processors::program::Frame render(bool record) const {
    processors::program::RenderOptions with = options;
    with.record = record;
    return processors::program::render(scene, *triangles, *structure, with, 1);
  }
};

std::string_view name_of(Scheme scheme) {
  return processors::machine::scheme_names[static_cast<std::size_t>(scheme)];
}

std::int64_t messages_of(const processors::replay::MachineResult& result) {
  std::int64_t messages = 0;
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    messages += network.messages;
  }
  return messages;
}

void print(std::string_view name, const processors::replay::MachineResult& result, double seconds,
           double render) {
  const auto references = static_cast<double>(result.references().references());
  std::printf("%-10.*s %8.1f ms %7.1f M references/s %10lld messages %10llu events %7.3f x render\n",
              static_cast<int>(name.size()), name.data(), 1e3 * seconds, references / seconds / 1e6,
              static_cast<long long>(messages_of(result)), static_cast<unsigned long long>(result.events),
              seconds / render);
}

void compare(bench::Report& report, std::uint32_t size, int repeats) {
  const Work work(size);
  const processors::program::Frame frame = work.render(true);
  double render = 1e300;
  std::vector<double> best(schemes.size(), 1e300);
  std::vector<processors::replay::MachineResult> results(schemes.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    double start = now();
    (void)work.render(false);
    render = std::min(render, now() - start);
    for (std::size_t i = 0; i < schemes.size(); ++i) {
      start = now();
      results[i] = processors::replay::replay(*frame.log, machine_of(schemes[i], 64));
      best[i] = std::min(best[i], now() - start);
    }
  }
  std::printf("teapot:12, %u x %u, depth 2; native render on one thread %.1f ms (best of %d); 64 nodes\n",
              size, size, 1e3 * render, repeats);
  for (std::size_t i = 0; i < schemes.size(); ++i) {
    print(name_of(schemes[i]), results[i], best[i], render);
    report.add(bench::against("replay, " + std::string(name_of(schemes[i])) + " scheme", "ms", 1e3 * best[i],
                              "native render", 1e3 * render, bench::Aim{most_renders[i], false}));
  }
}

void many(std::string_view name, std::uint32_t size) {
  const auto at = std::find_if(schemes.begin(), schemes.end(), [&](Scheme s) { return name_of(s) == name; });
  if (at == schemes.end()) {
    throw sim::UserError("there is no scheme \"" + std::string(name) + "\"");
  }
  const Work work(size);
  const double start = now();
  const processors::program::Frame frame = work.render(true);
  const double render = now() - start;
  const double begin = now();
  const processors::replay::MachineResult result =
      processors::replay::replay(*frame.log, machine_of(*at, 65536));
  print(name, result, now() - begin, render);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("65,536 nodes, %u x %u: peak memory of the process %.2f GiB\n", size, size,
              static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0));
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_schemes", argc, argv, [](bench::Report& report, int count, char** values) {
        if (count > 2 && std::string_view(values[1]) == "many") {
          many(values[2], count > 3 ? static_cast<std::uint32_t>(std::atoi(values[3])) : 512U);
        } else {
          compare(report, count > 1 ? static_cast<std::uint32_t>(std::atoi(values[1])) : 512U,
                  std::max(1, count > 2 ? std::atoi(values[2]) : 5));
        }
      });
}
