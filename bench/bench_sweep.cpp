// What a sweep saves: its machines beside the same machines each in a `marti run` of its own and beside the
// native render of the frame, in processor time; one thread against two; a finished sweep of 10,000 points
// opened again.
//   bench_sweep [SIZE [RUNS [CONFIG]]]     default: 256, 20, configs/sweep.toml
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "accel/triangles.h"
#include "bench/report.h"
#include "processors/program/render.h"
#include "sim/cpu_time.h"
#include "sim/error.h"
#include "sim/files.h"
#include "studies/run/open_frame.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/store/sweep_reader.h"

namespace {

using namespace marti;

struct Took {
  double cpu = 0.0;   // seconds, user and system
  double wall = 0.0;  // seconds
};

// Runs the program and discards its output.
Took run_program(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), MARTI_PROGRAM);
  std::vector<char*> argv;
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  const auto begin = std::chrono::steady_clock::now();
  std::fflush(stdout);  // otherwise the child would print buffered output again
  const pid_t child = fork();
  if (child == 0) {
    if (std::freopen("/dev/null", "w", stdout) != nullptr) {
      execv(argv[0], argv.data());
    }
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) {
    throw sim::UserError("a run of the program failed (see above)");
  }
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime),
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

// A temporary directory, removed by the destructor.
class Scratch {
 public:
  Scratch()
      : directory_(std::filesystem::temp_directory_path() / ("bench-sweep-" + std::to_string(getpid()))) {
    std::filesystem::create_directory(directory_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }

 private:
  std::filesystem::path directory_;
};

// Milliseconds of processor time that the frame takes to render on one thread, without a work log; the least
// of five.
double native_render(const studies::keys::FrameConfig& config) {
  const scenes::Scene scene = studies::run::open_frame(config);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const std::unique_ptr<accel::Structure> structure =
      accel::make_structure(config.structure, triangles, config.structure_options);
  processors::program::RenderOptions options = config.render;
  options.record = false;
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < 5; ++i) {
    const double begin = sim::process_cpu_seconds();
    (void)processors::program::render(scene, *triangles, *structure, options, 1);
    least = std::min(least, sim::process_cpu_seconds() - begin);
  }
  return 1e3 * least;
}

// Line references of all points of a store.
double references_in(const std::filesystem::path& store) {
  const studies::sweep::SweepReader reader(store);
  double sum = 0.0;
  const std::array<std::string, 2> names = {"hits", "misses"};
  reader.for_each_point(
      names, [&](const studies::sweep::StoredPoint& /*point*/, std::span<const studies::tables::Cell> cells) {
        for (const studies::tables::Cell& cell : cells) {
          sum += static_cast<double>(std::get<std::int64_t>(cell));
        }
      });
  return sum;
}

void compare_with_runs(bench::Report& report, const std::string& config, const std::string& size, int runs,
                       const Scratch& scratch) {
  const std::vector<std::string> image = {"--set", "image.width=" + size, "--set", "image.height=" + size};
  sim::Config read =
      sim::Config::from_file(studies::sweep::sweep_schema(), config, std::vector{image[1], image[3]});
  const studies::sweep::SweepPlan plan = studies::sweep::plan_sweep(read);

  Took separate;
  for (int i = 0; i < runs; ++i) {
    const std::size_t chosen =
        plan.points.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(runs) +
        plan.points.size() / static_cast<std::size_t>(2 * runs);
    std::vector<std::string> arguments = {"run", config, "-o", scratch.path("run")};
    arguments.insert(arguments.end(), image.begin(), image.end());
    for (const sim::EffectiveValue& value :
         studies::sweep::all_of(plan.machines[plan.points[chosen].machine].settings)) {
      if (value.given) {
        arguments.insert(arguments.end(), {"--set", value.key + "=" + value.value});
      }
    }
    separate.cpu += run_program(arguments).cpu / runs;
  }
  const auto sweep = [&](const std::string& threads) {
    std::vector<std::string> arguments = {
        "sweep", config, "--quiet", "--threads", threads, "-o", scratch.path("sweep-" + threads)};
    arguments.insert(arguments.end(), image.begin(), image.end());
    return run_program(arguments);
  };
  const Took one = sweep("1");
  const Took two = sweep("2");
  const auto machines = static_cast<double>(plan.machines.size());
  const std::filesystem::path store = scratch.path("sweep-1") + "/results.sqlite";
  const double references = references_in(store);

  std::printf("%s at %s x %s: %.0f machines\n", config.c_str(), size.c_str(), size.c_str(), machines);
  std::printf("a machine in a run of its own   %9.1f ms of processor time (mean of %d)\n", separate.cpu * 1e3,
              runs);
  std::printf("a machine of the sweep          %9.1f ms\n", one.cpu / machines * 1e3);
  const double render = native_render(plan.frames.front().config);
  std::printf("native render of the frame      %9.1f ms: a machine takes %.2f times that\n", render,
              one.cpu / machines * 1e3 / render);
  std::printf("references                      %9.1f M/s a core, all of the sweep's time counted\n",
              references / one.cpu * 1e-6);
  std::printf("one thread, two threads         %9.1f s, %.1f s: efficiency %.2f\n", one.wall, two.wall,
              one.wall / two.wall / 2.0);
  const auto bytes = static_cast<double>(std::filesystem::file_size(store)) / machines;
  std::printf("store                           %9.0f B a machine\n", bytes);
  report.add(bench::against("separate runs / sweep, a machine", "ms CPU", separate.cpu * 1e3, "sweep",
                            one.cpu / machines * 1e3, bench::Aim{20.0, true}));
  report.add(bench::against("a machine of the sweep", "ms CPU", one.cpu / machines * 1e3, "native render",
                            render, bench::Aim{0.6, false}));
  report.add({.name = "references of a sweep",
              .unit = "M/s a core",
              .ours = references / one.cpu * 1e-6,
              .aim = bench::Aim{200.0, true}});
  report.add({.name = "efficiency of two threads",
              .unit = "1",
              .ours = one.wall / two.wall / 2.0,
              .aim = bench::Aim{0.9, true}});
  report.add({.name = "store", .unit = "B a machine", .ours = bytes});
}

void open_again(bench::Report& report, const Scratch& scratch) {
  const std::string config = scratch.path("ten-thousand.toml");
  sim::write_file(config,
                  "[scene]\nsource = \"teapot:4\"\n[image]\nwidth = 8\nheight = 8\n[sweep.axes]\n"
                  "machine.nodes = \"1..512*2\"\ncache.size = \"8 KiB..4 MiB*2\"\n"
                  "cache.line = [16, 32, 64, 128]\ncache.ways = [1, 2, 4, 8, 16]\n"
                  "interconnect.width = \"4 B..64 B*2\"\n");
  const std::vector<std::string> arguments = {"sweep", config, "--quiet", "-o", scratch.path("many")};
  const Took first = run_program(arguments);
  const Took again = run_program(arguments);
  std::printf("10,000 points of a tiny frame   %9.1f s; the same command again %.2f s\n", first.wall,
              again.wall);
  report.add({.name = "a finished sweep of 10,000 points again",
              .unit = "s",
              .ours = again.wall,
              .aim = bench::Aim{2.0, false}});
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_sweep", argc, argv, [](bench::Report& report, int count, char** values) {
    const std::string size = count > 1 ? values[1] : "256";
    const int runs = std::max(1, count > 2 ? std::atoi(values[2]) : 20);
    const Scratch scratch;
    compare_with_runs(report, count > 3 ? values[3] : "configs/sweep.toml", size, runs, scratch);
    open_again(report, scratch);
  });
}
