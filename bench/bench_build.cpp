// Building octrees on the host: time per triangle, memory, and what the lazy octree and the partial rebuild
// save.
//   bench_build [million] [growth] [lazy] [update] [--json FILE]     default: all four
//
// The scenes that grow keep their shape: teapot:n is the same surface in about 65 n^2 triangles, tetra:n the
// same Sierpinski tetrahedron in 4^n.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accel/lazy_octree.h"
#include "accel/octree.h"
#include "accel/octree_update.h"
#include "accel/structure.h"
#include "bench/report.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"
#include "sim/cpu_time.h"
#include "sim/error.h"

namespace {

using namespace marti;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::shared_ptr<const accel::TriangleSet> triangles_of(const std::string& scene) {
  return std::make_shared<const accel::TriangleSet>(scenes::make_procedural(scene));
}

/// The best of several builds, in seconds; short builds are repeated more often. For one thread this is
/// processor time, for all threads elapsed time.
double best_build(const std::shared_ptr<const accel::TriangleSet>& triangles, unsigned threads) {
  accel::OctreeOptions options;
  options.threads = threads;
  double best = std::numeric_limits<double>::infinity();
  double spent = 0.0;
  for (int round = 0; round < 3 || (spent < 1.0 && round < 100); ++round) {
    const auto begin = Clock::now();
    const double cpu_begin = sim::thread_cpu_seconds();
    const accel::Octree octree = accel::Octree::build(triangles, options);
    best = std::min(best, threads == 1 ? sim::thread_cpu_seconds() - cpu_begin : since(begin));
    spent += since(begin);
  }
  return best;
}

/// Build time against the number of triangles, and c n log2 n fitted to it.
void growth(bench::Report& report) {
  const std::vector<std::vector<std::string>> families{
      {"teapot:4", "teapot:7", "teapot:12", "teapot:22", "teapot:39", "teapot:70", "teapot:124"},
      {"tetra:5", "tetra:6", "tetra:7", "tetra:8", "tetra:9", "tetra:10"}};
  std::printf("octree build, max_objects 8, max_level 12; best of several (1 thread: processor time)\n");
  std::printf("%-12s %9s %9s %10s | %9s %8s %10s | %9s %8s\n", "scene", "triangles", "nodes", "entries",
              "1 thread", "ns/tri", "ns/n log2n", "all", "speed-up");
  for (const std::vector<std::string>& family : families) {
    std::vector<double> sizes;
    std::vector<double> times;
    for (const std::string& scene : family) {
      const auto triangles = triangles_of(scene);
      const accel::Octree octree = accel::Octree::build(triangles);
      const double one = best_build(triangles, 1);
      const double all = best_build(triangles, 0);
      const double n = triangles->size();
      sizes.push_back(n);
      times.push_back(one);
      std::printf("%-12s %9u %9zu %10zu | %7.2f ms %8.0f %10.2f | %7.2f ms %8.2f\n", scene.c_str(),
                  triangles->size(), octree.topology().nodes.size(), octree.topology().entries.size(),
                  1e3 * one, 1e9 * one / n, 1e9 * one / (n * std::log2(n)), 1e3 * all, one / all);
      if (scene == family.back()) {
        report.add({"octree build of " + scene + ", one thread", "ns/triangle", 1e9 * one / n});
        report.add(bench::against("octree build of " + scene + ", all threads", "ms elapsed", 1e3 * all,
                                  "one thread", 1e3 * one));
      }
    }
    // In logarithms, so that each size has the same weight.
    double mean = 0.0;
    double x_mean = 0.0;
    double y_mean = 0.0;
    const auto count = static_cast<double>(sizes.size());
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      mean += std::log(times[k] / (sizes[k] * std::log2(sizes[k]))) / count;
      x_mean += std::log(sizes[k]) / count;
      y_mean += std::log(times[k]) / count;
    }
    double xy = 0.0;
    double xx = 0.0;
    double worst = 0.0;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      const double x = std::log(sizes[k]) - x_mean;
      xy += x * (std::log(times[k]) - y_mean);
      xx += x * x;
      const double fitted = std::exp(mean) * sizes[k] * std::log2(sizes[k]);
      worst = std::max(worst, std::abs(times[k] / fitted - 1.0));
    }
    std::printf("  fit: %.2f ns n log2 n, off by at most %.0f %%; as a power, n^%.3f\n", 1e9 * std::exp(mean),
                100.0 * worst, xy / xx);
  }
}

/// Builds and renders a scene in a process of its own; prints its times and the most memory it had.
void build_and_render(bench::Report& report, const std::string& name) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) {
    throw sim::UserError("bench_build: this computer starts no more processes");
  }
  if (child == 0) {
    const scenes::Scene scene = scenes::make_procedural(name);
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const auto begin = Clock::now();
    const auto octree = accel::make_structure("octree", triangles);
    const double built = since(begin);
    const processors::program::RenderOptions options{.width = 512, .height = 512, .max_depth = 2};
    const auto render_begin = Clock::now();
    const processors::program::Frame frame = processors::program::render(scene, *triangles, *octree, options);
    std::printf("%-12s %9u %9zu %9zu | %6.2f s %6.2f s %9llu | ", name.c_str(), triangles->size(),
                octree->topology().nodes.size(), octree->topology().entries.size(), built,
                since(render_begin), static_cast<unsigned long long>(frame.rays.all()));
    std::fflush(stdout);
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || status != 0) {
    throw sim::UserError("bench_build: the render of " + name + " failed");
  }
  const double peak = static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
  std::printf("%6.2f GiB\n", peak);
  report.add({name + " built and rendered", "GiB peak", peak, "", 0.0, std::nullopt, bench::Aim{4.0, false}});
}

void million(bench::Report& report) {
  std::printf("a million triangles, built and rendered (512 x 512, depth 2, all threads)\n");
  std::printf("%-12s %9s %9s %9s | %8s %8s %9s | %10s\n", "scene", "triangles", "nodes", "entries", "build",
              "render", "rays", "peak memory");
  for (const char* scene : {"teapot:124", "tetra:10", "gears:12"}) {
    build_and_render(report, scene);
  }
}

std::string label_of(const accel::BuildLimit& limit) {
  if (limit.level > 0) {
    return std::to_string(limit.level);
  }
  char text[32] = "full";
  if (limit.k > 0.0) {
    std::snprintf(text, sizeof text, "k = %g", limit.k);
  }
  return text;
}

/// Building to each initial level, then rendering, all on one thread; shares are of the fully built tree.
void lazy(bench::Report& report) {
  for (const char* name : {"teapot:12", "teapot:39", "gears:2", "gears:4", "tetra:8"}) {
    const scenes::Scene scene = scenes::make_procedural(name);
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const processors::program::RenderOptions options{.width = 256, .height = 256, .max_depth = 2};
    std::vector<accel::BuildLimit> limits{{0, 0.0}, {0, 3.0}, {0, 10.0}};
    for (std::uint32_t level = 1; level <= 8; ++level) {
      limits.push_back({level, 0.0});
    }
    struct Result {
      double build = std::numeric_limits<double>::infinity();
      double render = std::numeric_limits<double>::infinity();
      double total = std::numeric_limits<double>::infinity();
      accel::LazyOctreeState state;
    };
    std::vector<Result> results(limits.size());
    // In turns, so that other work on the computer affects all alike.
    for (int round = 0; round < 5; ++round) {
      for (std::size_t k = 0; k < limits.size(); ++k) {
        accel::LazyOctreeOptions lazy_options;
        lazy_options.tree.threads = 1;
        lazy_options.initial = limits[k];
        const double begin = sim::thread_cpu_seconds();
        const auto structure = accel::make_lazy_octree(triangles, lazy_options);
        const double built = sim::thread_cpu_seconds() - begin;
        (void)processors::program::render(scene, *triangles, *structure, options, 1);
        const double total = sim::thread_cpu_seconds() - begin;
        Result& result = results[k];
        result.build = std::min(result.build, built);
        result.render = std::min(result.render, total - built);
        result.total = std::min(result.total, total);
        result.state =
            dynamic_cast<const accel::StructureOf<accel::LazyOctree>&>(*structure).concrete().state();
      }
    }
    const Result& full = results.front();
    const auto bytes = [](const Result& r) {
      return static_cast<double>(r.state.node_bytes + r.state.list_bytes);
    };
    std::printf("%s: %u triangles, 256 x 256, depth 2, processor time of one thread, best of 5\n", name,
                triangles->size());
    std::printf("%-8s %9s %9s %9s | %9s %7s %7s | %12s %12s\n", "initial", "build ms", "render ms",
                "total ms", "nodes", "P made", "P left", "memory saved", "total saved");
    for (std::size_t k = 0; k < limits.size(); ++k) {
      const Result& r = results[k];
      std::printf("%-8s %9.2f %9.2f %9.2f | %9llu %7llu %7llu | %10.1f %% %10.1f %%\n",
                  label_of(limits[k]).c_str(), 1e3 * r.build, 1e3 * r.render, 1e3 * r.total,
                  static_cast<unsigned long long>(r.state.all.nodes()),
                  static_cast<unsigned long long>(r.state.subdivided),
                  static_cast<unsigned long long>(r.state.all.pending),
                  100.0 * (1.0 - bytes(r) / bytes(full)), 100.0 * (1.0 - r.total / full.total));
    }
    report.add(bench::against(std::string(name) + " built on demand, k = 10, and rendered", "ms",
                              1e3 * results[2].total, "built in full", 1e3 * full.total));
  }
}

/// A share of neighbouring triangles moves: the partial rebuild against a fresh one, on one thread.
void update(bench::Report& report) {
  std::printf(
      "partial rebuild after neighbouring triangles moved, processor time of one thread, best of 5\n");
  std::printf("%-12s %9s %9s | %9s %9s %7s | %10s %10s\n", "scene", "triangles", "moved", "fresh ms",
              "update ms", "ratio", "tests", "of fresh");
  for (const char* name : {"teapot:39", "gears:4"}) {
    const auto before = triangles_of(name);
    accel::OctreeOptions options;
    options.threads = 1;
    options.enclose.include(before->bounds().lo - 0.1);
    options.enclose.include(before->bounds().hi + 0.1);
    const accel::Octree tree = accel::Octree::build(before, options);
    for (const double share : {0.0, 0.001, 0.01, 0.1, 0.5, 1.0}) {
      std::vector<accel::TriangleCorners> corners;
      for (std::uint32_t id = 0; id < before->size(); ++id) {
        corners.push_back((*before)[id]);
        if (id < share * before->size()) {
          for (std::size_t corner = 0; corner < 3; ++corner) {
            corners.back()[3 * corner] += 0.01;
          }
        }
      }
      const accel::TriangleSet after(std::move(corners));
      double fresh = std::numeric_limits<double>::infinity();
      double partial = std::numeric_limits<double>::infinity();
      std::uint64_t tests = 0;
      std::uint64_t all_tests = 0;
      std::uint32_t moved = 0;
      for (int round = 0; round < 5; ++round) {
        double begin = sim::thread_cpu_seconds();
        (void)accel::build_octree(after, options, tree.frame());
        fresh = std::min(fresh, sim::thread_cpu_seconds() - begin);
        begin = sim::thread_cpu_seconds();
        const accel::OctreeUpdate updated = accel::update_octree(tree, after);
        partial = std::min(partial, sim::thread_cpu_seconds() - begin);
        tests = 0;
        all_tests = 0;
        moved = updated.moved;
        for (std::size_t n = 0; n < updated.work.size(); ++n) {
          tests += updated.work[n].overlaps;
          all_tests += updated.build.topology.work[n].overlaps;
        }
      }
      std::printf("%-12s %9u %9u | %9.2f %9.2f %7.3f | %10llu %8.1f %%\n", name, before->size(), moved,
                  1e3 * fresh, 1e3 * partial, partial / fresh, static_cast<unsigned long long>(tests),
                  100.0 * static_cast<double>(tests) / static_cast<double>(all_tests));
      if (share == 0.01) {
        report.add(bench::against(std::string(name) + ", 1 % moved: octree updated", "ms", 1e3 * partial,
                                  "built anew", 1e3 * fresh));
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark("bench_build", argc, argv, [](bench::Report& report, int count, char** values) {
    std::vector<std::string_view> parts(values + 1, values + count);
    if (parts.empty()) {
      parts = {"million", "growth", "lazy", "update"};
    }
    // First, because it forks, which must happen before this process has threads.
    std::stable_sort(parts.begin(), parts.end(),
                     [](std::string_view a, std::string_view b) { return a == "million" && b != "million"; });
    for (const std::string_view part : parts) {
      if (part == "million") {
        million(report);
      } else if (part == "growth") {
        growth(report);
      } else if (part == "lazy") {
        lazy(report);
      } else if (part == "update") {
        update(report);
      } else {
        throw sim::UserError("usage: bench_build [million] [growth] [lazy] [update] [--json FILE]");
      }
    }
  });
}
