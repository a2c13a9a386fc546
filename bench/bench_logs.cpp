// What a work log costs on disk: time to write and to read it, its size, against the time to record it.
//   bench_logs [SCENE [SIZE [REPEATS]]]     default: teapot:12 512 7
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "accel/structure.h"
#include "bench/report.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "sim/files.h"
#include "studies/sweep/log_file.h"

namespace {

using namespace marti;

/// The best of some passes, in milliseconds.
double best(int repeats, const std::function<void()>& work) {
  double least = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    least = std::min(least, took.count());
  }
  return least;
}

void run(bench::Report& report, const std::string& name, std::uint32_t size, int repeats) {
  const scenes::Scene scene = scenes::make_procedural(name);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", triangles);
  const processors::RenderOptions options{.width = size, .height = size, .max_depth = 2, .record = true};
  const std::string key(32, '0');
  for (const unsigned threads : {1U, 0U}) {
    const std::size_t most =
        threads == 0 ? tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)
                     : threads;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, most);
    studies::FrameLog frame;
    frame.row.counters.resize(studies::frame_columns().size());
    const double record = best(repeats, [&] {
      frame.log = processors::render(scene, *triangles, *structure, options, threads).log;
    });
    const double check = best(repeats, [&] { processors::validate(*frame.log); });
    std::uintmax_t bytes = 0;
    double write = 1e300;
    double read = 1e300;
    for (int i = 0; i < repeats; ++i) {
      const sim::PendingFile file("bench_logs.log");
      write =
          std::min(write, best(1, [&] { studies::write_log_file(file.temporary(), frame, key, "bench"); }));
      bytes = std::filesystem::file_size(file.temporary());
      const auto source = studies::log_file_source(file.temporary());
      read = std::min(
          read, best(1, [&] { static_cast<void>(studies::read_log(*source, key, "bench", UINT64_MAX)); }));
    }
    std::printf("%s, %u x %u, depth 2, %zu threads: best of %d\n", name.c_str(), size, size, most, repeats);
    std::printf("record        %10.1f ms\n", record);
    std::printf("write         %10.1f ms\n", write);
    std::printf("read          %10.1f ms  (of it the check %.1f)\n", read, check);
    std::printf("in memory     %10.1f MB\n", static_cast<double>(studies::memory_of(*frame.log)) / 1e6);
    std::printf("on disk       %10.1f MB\n", static_cast<double>(bytes) / 1e6);
    const std::string with = ", " + std::to_string(most) + " threads";
    report.add(bench::against("writing a work log" + with, "ms", write, "recording it", record));
    report.add(bench::against("reading a work log" + with, "ms", read, "recording it", record));
  }
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_logs", argc, argv, [](bench::Report& report, int count, char** values) {
    run(report, count > 1 ? values[1] : "teapot:12",
        count > 2 ? static_cast<std::uint32_t>(std::atoi(values[2])) : 512U,
        std::max(1, count > 3 ? std::atoi(values[3]) : 7));
  });
}
