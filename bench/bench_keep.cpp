// What the plan of a run saves: processor time and peak memory of each shipped scene, with the plan and with
// everything kept. Each run is a process of its own, so that its peak memory can be measured.
//   bench_keep [SIZE [REPEATS [FILE...]]]     default: 128, 3; FILE: scenes beside the procedural ones
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/report.h"
#include "scenes/procedural.h"
#include "sim/config.h"
#include "studies/run/run_result.h"

namespace {

using namespace marti;

struct Usage {
  double seconds = 0.0;
  double mebibytes = 0.0;
};

void run_once(const std::string& scene, const std::string& size, const studies::run::KeptItems& keep) {
  const std::vector<std::string> keys = {"scene.source=" + scene, "image.width=" + size,
                                         "image.height=" + size};
  sim::Config config = sim::Config::from_text(studies::run::run_schema(), "", "bench", keys);
  static_cast<void>(studies::run::run(config, {.keep = keep}));
}

// A plain fork is safe, because the parent starts no threads.
Usage measure(const std::string& scene, const std::string& size, const studies::run::KeptItems& keep) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    try {
      run_once(scene, size, keep);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", scene.c_str(), error.what());
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  rusage used{};
  if (child < 0 || wait4(child, &status, 0, &used) != child || status != 0) {
    throw sim::InternalError("the run of " + scene + " has failed");
  }
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(used.ru_utime) + seconds(used.ru_stime), static_cast<double>(used.ru_maxrss) / 1024.0};
}

Usage median(std::vector<Usage> usages) {
  const auto middle = [&](double Usage::*part) {
    std::sort(usages.begin(), usages.end(),
              [part](const Usage& a, const Usage& b) { return a.*part < b.*part; });
    return usages[usages.size() / 2].*part;
  };
  return {middle(&Usage::seconds), middle(&Usage::mebibytes)};
}

void run(bench::Report& report, const std::string& size, int repeats, const std::vector<std::string>& files) {
  std::vector<std::string> scenes;
  for (const scenes::ProceduralScene& scene : scenes::procedural_scenes()) {
    scenes.push_back(std::string(scene.name) + ":" + std::to_string(scene.default_size));
  }
  scenes.insert(scenes.end(), files.begin(), files.end());
  const std::vector<studies::run::KeptItems> kept = {studies::run::KeptItems(),
                                                     studies::run::KeptItems::all()};
  std::printf("%-16s %17s %17s\n", "", "processor time, s", "peak memory, MiB");
  std::printf("%-16s %8s %8s %8s %8s\n", "scene", "plan", "kept", "plan", "kept");
  for (const std::string& scene : scenes) {
    std::vector<std::vector<Usage>> usages(kept.size());
    for (int repeat = 0; repeat < repeats; ++repeat) {
      for (std::size_t i = 0; i < kept.size(); ++i) {
        usages[i].push_back(measure(scene, size, kept[i]));
      }
    }
    const Usage plan = median(usages[0]);
    const Usage all = median(usages[1]);
    const std::string name = scene.substr(scene.rfind('/') + 1);
    std::printf("%-16s %8.3f %8.3f %8.1f %8.1f\n", name.c_str(), plan.seconds, all.seconds, plan.mebibytes,
                all.mebibytes);
    report.add(bench::against(name + ", plan", "s", plan.seconds, "everything kept", all.seconds));
    report.add(
        bench::against(name + ", plan, peak", "MiB", plan.mebibytes, "everything kept", all.mebibytes));
  }
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_keep", argc, argv, [](bench::Report& report, int count, char** values) {
    run(report, count > 1 ? values[1] : "128", std::max(1, count > 2 ? std::atoi(values[2]) : 3),
        {values + std::min(count, 3), values + count});
  });
}
