// What the work log costs: the render without and with it in processor time of one thread, its size, and the
// size that other encodings of the same steps would have.
//   bench_recording [SCENE [SIZE [REPEATS]]] [--json FILE]     default: teapot:12 512 11
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure.h"
#include "bench/report.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace {

using namespace marti;

double seconds(const std::vector<double>& sorted, double quantile) {
  return sorted[static_cast<std::size_t>(quantile * static_cast<double>(sorted.size() - 1))];
}

/// Counts how often a leaf ended early, which the totals do not tell.
std::uint64_t partial_leaves(const processors::program::WorkLog& log) {
  std::uint64_t count = 0;
  for (const processors::program::LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size();
         at += processors::program::step_words(row.words.data() + at)) {
      count +=
          processors::program::step_of(row.words[at]) == processors::program::Step::partial_leaf ? 1U : 0U;
    }
  }
  return count;
}

void run(bench::Report& report, const std::string& name, std::uint32_t size, int repeats) {
  const scenes::Scene scene = scenes::make_procedural(name);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", triangles);
  processors::program::RenderOptions options{.width = size, .height = size, .max_depth = 2};

  // In turns, so that other work on the host affects both alike; the first pair only warms up.
  std::vector<double> times[2];
  processors::program::Frame recorded;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    for (const bool record : {false, true}) {
      options.record = record;
      const std::clock_t start = std::clock();
      processors::program::Frame frame =
          processors::program::render(scene, *triangles, *structure, options, 1);
      const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      if (repeat > 0) {
        times[record ? 1 : 0].push_back(took);
      }
      if (record) {
        recorded = std::move(frame);
      }
    }
  }
  for (auto& of_kind : times) {
    std::sort(of_kind.begin(), of_kind.end());
  }

  const processors::program::LogTotals totals = processors::program::totals_of(*recorded.log);
  const auto rays = static_cast<double>(totals.all_rays());
  const auto steps = static_cast<double>(totals.all_steps());
  const double pixels = static_cast<double>(size) * size;
  std::printf("%s, %u x %u, depth 2, one thread, %d repeats\n", name.c_str(), size, size, repeats);
  std::printf(
      "rays                     %12.0f  (camera %llu, shadow %llu, reflection %llu, refraction %llu)\n", rays,
      static_cast<unsigned long long>(totals.rays[0]), static_cast<unsigned long long>(totals.rays[1]),
      static_cast<unsigned long long>(totals.rays[2]), static_cast<unsigned long long>(totals.rays[3]));
  std::printf("render without log       %12.2f ms best, %.2f median\n", 1e3 * times[0].front(),
              1e3 * seconds(times[0], 0.5));
  std::printf("render with log          %12.2f ms best, %.2f median\n", 1e3 * times[1].front(),
              1e3 * seconds(times[1], 0.5));
  std::printf("recording ratio          %12.3f best, %.3f median\n", times[1].front() / times[0].front(),
              seconds(times[1], 0.5) / seconds(times[0], 0.5));
  std::printf("steps per ray            %12.2f  (branches %.2f, leaves %.2f, tests %.2f)\n", steps / rays,
              static_cast<double>(totals.branches) / rays, static_cast<double>(totals.leaves) / rays,
              static_cast<double>(totals.tests) / rays);
  std::printf("bytes per ray            %12.2f  (%.1f MB)\n", static_cast<double>(totals.bytes) / rays,
              static_cast<double>(totals.bytes) / 1e6);

  report.add(bench::against("render with work log, best", "ms", 1e3 * times[1].front(), "without log",
                            1e3 * times[0].front(), bench::Aim{1.3, false}));
  report.add(bench::against("render with work log, median", "ms", 1e3 * seconds(times[1], 0.5), "without log",
                            1e3 * seconds(times[0], 0.5), bench::Aim{1.3, false}));
  report.add({"work log", "B/ray", static_cast<double>(totals.bytes) / rays});

  // Other encodings of the same steps. Each includes the offsets of the pixels.
  const double offsets = 4.0 * (pixels + size);
  const double every_step = 4.0 * (steps + static_cast<double>(totals.texels)) + offsets;
  std::printf("  a word for every step  %12.2f\n", every_step / rays);
  // A branch's visited children as a bit mask: their order follows from the ray's octant, leaves from the
  // tree. The reader then walks the tree anew, with a stack.
  const auto partial = static_cast<double>(partial_leaves(*recorded.log));
  const double masks = 4.0 * (rays + static_cast<double>(totals.shades + totals.lights) +
                              2.0 * static_cast<double>(totals.texels) + partial) +
                       static_cast<double>(totals.branches) + offsets;
  std::printf("  a byte for a branch    %12.2f\n", masks / rays);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_recording", argc, argv,
                              [](bench::Report& report, int count, char** values) {
                                run(report, count > 1 ? values[1] : "teapot:12",
                                    count > 2 ? static_cast<std::uint32_t>(std::atoi(values[2])) : 512U,
                                    std::max(1, count > 3 ? std::atoi(values[3]) : 11));
                              });
}
