// How long the plan of a sweep takes: reading, checking and hashing 10,000 machines on all host cores.
//   bench_plan [CONFIG [REPEATS]]     default: 10,000 machines of its own, 11
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/report.h"
#include "sim/config.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace {

using namespace marti;

constexpr std::string_view ten_thousand =
    "[sweep.axes]\n"
    "machine.nodes = { from = 1, to = 512, steps = 10, scale = \"log\" }\n"
    "cache.size = { from = \"8 KiB\", to = \"4 MiB\", steps = 10, scale = \"log\" }\n"
    "cache.line = [16, 32, 64, 128]\n"
    "cache.ways = [1, 2, 4, 8, 16]\n"
    "interconnect.width = { from = 4, to = 64, steps = 5, scale = \"log\" }\n";

void run(bench::Report& report, const std::string& file, int repeats) {
  const sim::Schema schema = studies::sweep::sweep_schema();
  std::vector<double> times;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    sim::Config config = file.empty() ? sim::Config::from_text(schema, ten_thousand, "bench")
                                      : sim::Config::from_file(schema, file);
    const auto start = std::chrono::steady_clock::now();
    const studies::sweep::SweepPlan plan = studies::sweep::plan_sweep(config);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    times.push_back(took.count());
    if (repeat == 0) {
      std::printf("%zu points, %zu machines, %zu frames\n", plan.points.size(), plan.machines.size(),
                  plan.frames.size());
    }
  }
  std::sort(times.begin(), times.end());
  std::printf("plan: %.3f s at best, %.3f s median of %zu\n", times.front(), times[times.size() / 2],
              times.size());
  report.add({.name = "plan of a sweep", .unit = "s", .ours = times.front()});
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_plan", argc, argv, [](bench::Report& report, int count, char** values) {
    run(report, count > 1 ? values[1] : "", std::max(1, count > 2 ? std::atoi(values[2]) : 11));
  });
}
