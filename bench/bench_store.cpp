// The store of a sweep: entering a plan, adding results, opening it again, bytes a machine. The rows are
// those of real machines, each used many times.
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/report.h"
#include "processors/replay/replay.h"
#include "sim/config.h"
#include "sim/error.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/functional_run.h"
#include "studies/run/run_result.h"
#include "studies/sweep/store/sweep_store.h"

namespace {

using namespace marti;

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string key_of(std::size_t number) {
  std::string key(32, '0');
  const std::string digits = std::to_string(number);
  return key.replace(32 - digits.size(), digits.size(), digits);
}

struct Sweep {
  studies::sweep::SweepPlan plan;
  studies::sweep::FrameRow frame;
  std::vector<studies::sweep::SweepRow> rows;  // used in turns
};

Sweep make_sweep(std::size_t machines) {
  constexpr std::size_t different = 16;
  Sweep sweep;
  studies::sweep::SettingsPool pool;
  sweep.plan.axes = {"machine.nodes", "cache.size", "interconnect.width"};
  std::shared_ptr<const processors::program::WorkLog> log;
  for (std::size_t i = 0; i < machines; ++i) {
    const std::int64_t nodes = std::int64_t{1} << (i % 7);
    const std::int64_t size = std::int64_t{1024} << (i / 7 % 6);
    sim::Config config = sim::Config::from_text(
        studies::run::run_schema(), "scene.source = \"teapot:6\"\nimage.width = 128\nimage.height = 128\n",
        "bench",
        std::vector<std::string>{"machine.nodes=" + std::to_string(nodes),
                                 "cache.size=" + std::to_string(size) + " B",
                                 "host.latency_cycles=" + std::to_string(i / 42)});
    const studies::keys::FrameConfig frame = studies::keys::read_frame(config);
    const std::vector<sim::EffectiveValue> of_frame = config.effective_values();
    const processors::machine::MachineConfig machine = studies::keys::read_machine(config);
    std::vector<sim::EffectiveValue> of_machine;
    for (sim::EffectiveValue& value : config.effective_values()) {
      bool known = false;
      for (const sim::EffectiveValue& other : of_frame) {
        known = known || other.key == value.key;
      }
      if (!known) {
        of_machine.push_back(value);
      }
    }
    if (i == 0) {
      const studies::run::FunctionalRun run = studies::run::run_functional(frame);
      log = run.frame.log;
      sweep.frame = studies::sweep::frame_row(run, 0);
      sweep.plan.frames.push_back({key_of(0), frame, of_frame});
    }
    if (sweep.rows.size() < different) {
      sweep.rows.push_back(studies::sweep::sweep_row(machine, processors::replay::replay(*log, machine)));
    }
    sweep.plan.machines.push_back({key_of(i), 0, i, machine, pool.share(of_machine)});
    sweep.plan.points.push_back({{nodes, size, static_cast<std::int64_t>(i / 42)}, i, 0, 1.0});
  }
  return sweep;
}

void run(bench::Report& report, std::size_t machines, const std::filesystem::path& directory) {
  const Sweep sweep = make_sweep(machines);
  const std::filesystem::path file = directory / "results.sqlite";
  const auto said = [&report](const char* what, double seconds) {
    std::printf("%-28s%10.3f s\n", what, seconds);
    report.add({.name = what, .unit = "s", .ours = seconds});
  };
  std::printf("%zu machines, %zu settings each\n", machines,
              studies::sweep::all_of(sweep.plan.machines[0].settings).size());
  {
    Stopwatch watch;
    studies::sweep::SweepStore store(file, sweep.plan);
    said("new store, plan entered", watch.seconds());
    Stopwatch adding;
    store.add_frame(0, sweep.frame, 0);
    for (std::size_t i = 0; i < machines; ++i) {
      store.add_result(i, sweep.rows[i % sweep.rows.size()], 0);
    }
    said("results added", adding.seconds());
    Stopwatch closing;
    store.close();
    said("closed", closing.seconds());
  }
  const auto bytes = static_cast<double>(std::filesystem::file_size(file));
  std::printf("%-28s%10.0f B\n", "a machine", bytes / static_cast<double>(machines));
  report.add({.name = "store, a machine", .unit = "B", .ours = bytes / static_cast<double>(machines)});
  Stopwatch watch;
  studies::sweep::SweepStore store(file, sweep.plan);
  const std::vector<bool> done = store.done();
  said("finished store opened again", watch.seconds());
  for (const bool there : done) {
    if (!there) {
      throw sim::InternalError("a result is missing");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_store", argc, argv, [](bench::Report& report, int count, char** values) {
    const std::filesystem::path directory =
        std::filesystem::temp_directory_path() / ("bench-store-" + std::to_string(getpid()));
    std::filesystem::create_directory(directory);
    run(report, count > 1 ? std::strtoul(values[1], nullptr, 10) : 10000, directory);
    std::filesystem::remove_all(directory);
  });
}
