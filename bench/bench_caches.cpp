// How fast references are looked up: the tag stores, whole replays and the one-pass miss counts beside plain
// trace-driven cache simulators, on the same stream of lines and in turns, in processor time of one thread.
//   bench_caches [SIZE [REPEATS]] [--json FILE]     default: 512 5
//
// The stream is the references of one node of bench_replay's machine (4-way 16 KiB cache with lines of 32
// bytes) that traces teapot:12.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "accel/structure.h"
#include "bench/report.h"
#include "memory/all_ways.h"
#include "memory/stack_distance.h"
#include "memory/tags.h"
#include "processors/cost/cost_model.h"
#include "processors/passes/working_set.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/support/heard_references.h"

namespace {

using namespace marti;

/// Set-associative LRU as textbooks have it: each way of a set has a tag and the time of its last use; a miss
/// replaces the way whose last use is the longest ago.
class PlainCache {
 public:
  PlainCache(std::uint32_t sets, std::uint32_t ways)
      : sets_(sets), ways_(ways), of_sets_(std::size_t{sets} * ways) {}

  bool access(std::uint32_t line) {
    Way* const set = of_sets_.data() + std::size_t{line & (sets_ - 1)} * ways_;
    ++now_;
    Way* oldest = set;
    for (Way* way = set; way != set + ways_; ++way) {
      if (way->last_use != 0 && way->tag == line) {
        way->last_use = now_;
        return true;
      }
      if (way->last_use < oldest->last_use) {
        oldest = way;
      }
    }
    *oldest = {line, now_};
    return false;
  }

 private:
  struct Way {
    std::uint64_t tag = 0;
    std::uint64_t last_use = 0;  // 0: empty
  };
  std::uint32_t sets_;  // a power of two
  std::uint32_t ways_;
  std::uint64_t now_ = 0;
  std::vector<Way> of_sets_;
};

/// Fully associative LRU as textbooks have it: a list from the newest line to the oldest, and a hash table
/// that finds a line in it.
class ListCache {
 public:
  explicit ListCache(std::size_t lines) : lines_(lines) {}

  bool access(std::uint32_t line) {
    if (const auto at = places_.find(line); at != places_.end()) {
      order_.splice(order_.begin(), order_, at->second);
      return true;
    }
    if (order_.size() == lines_) {
      places_.erase(order_.back());
      order_.pop_back();
    }
    order_.push_front(line);
    places_[line] = order_.begin();
    return false;
  }

 private:
  std::size_t lines_;
  std::list<std::uint32_t> order_;
  std::unordered_map<std::uint32_t, std::list<std::uint32_t>::iterator> places_;
};

// Processor time, which other work on the computer affects least.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

constexpr memory::CacheConfig cache_config{.size = 16 * 1024, .line = 32, .ways = 4};

processors::machine::MachineConfig machine_of() {
  processors::machine::MachineConfig machine;
  machine.nodes = 1;
  machine.clock = sim::Clock::from_hertz(100e6);
  machine.operations = processors::cost::cost_preset("unit");
  machine.packets = {8, 8, processors::machine::PacketOrder::scanline};
  machine.cache.cache = cache_config;
  return machine;
}

template <class Cache>
std::int64_t misses_of(Cache& cache, const std::vector<std::uint32_t>& lines) {
  std::int64_t misses = 0;
  for (const std::uint32_t line : lines) {
    misses += cache.access(line) ? 0 : 1;
  }
  return misses;
}

struct Contestant {
  std::string name;
  std::function<bool()> pass;  // returns whether it has found the same misses as the others
  double seconds = std::numeric_limits<double>::infinity();
};

void run(bench::Report& report, std::uint32_t size, int repeats) {
  const scenes::Scene scene = scenes::make_procedural("teapot:12");
  const auto primitives = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("octree", primitives);
  const processors::program::RenderOptions options{
      .width = size, .height = size, .max_depth = 2, .record = true};
  const processors::program::Frame frame =
      processors::program::render(scene, *primitives, *structure, options);
  const processors::machine::MachineConfig machine = machine_of();
  const memory::CacheShape shape = memory::shape_of(cache_config);
  test::HeardReferences trace;
  const std::int64_t misses =
      processors::replay::replay(*frame.log, machine, {.observer = &trace}).references().all_misses();
  std::vector<std::uint32_t> lines;
  trace.for_each(0, [&](const test::HeardReference& reference) {
    if (!reference.write) {
      lines.push_back(static_cast<std::uint32_t>(reference.address / cache_config.line));
    }
  });

  constexpr std::uint32_t full_lines = 512;  // as many as the machine's cache has
  std::int64_t full_misses = 0;
  std::vector<Contestant> all;
  all.push_back({"plain simulator", [&] {
                   PlainCache cache(shape.sets, shape.ways);
                   return misses_of(cache, lines) == misses;
                 }});
  all.push_back({"tag store", [&] {
                   return memory::with_tag_store(cache_config.replacement, shape, [&]<class Tags>() {
                     Tags tags(shape, 1, cache_config.seed);
                     auto cache = tags.view(0);
                     return misses_of(cache, lines) == misses;
                   });
                 }});
  all.push_back({"whole replay", [&] {
                   return processors::replay::replay(*frame.log, machine).references().all_misses() == misses;
                 }});
  all.push_back({"plain, 1 to 16 ways", [&] {
                   bool found = false;
                   for (std::uint32_t ways = 1; ways <= processors::passes::counted_ways; ++ways) {
                     PlainCache cache(shape.sets, ways);
                     found = misses_of(cache, lines) == misses || found;
                   }
                   return found;
                 }});
  all.push_back({"all ways in one pass", [&] {
                   memory::AllWays ways({shape.sets}, processors::passes::counted_ways);
                   for (const std::uint32_t line : lines) {
                     ways.access(line);
                   }
                   return ways.histograms()[0].misses(shape.ways) == misses;
                 }});
  all.push_back({"list and hash table", [&] {
                   ListCache cache(full_lines);
                   full_misses = misses_of(cache, lines);
                   return true;
                 }});
  all.push_back({"all LRU sizes in one pass", [&] {
                   memory::StackDistances distances;
                   for (const std::uint32_t line : lines) {
                     distances.access(line);
                   }
                   return distances.histogram().misses(full_lines) == full_misses;
                 }});
  all.push_back(
      {"working set of the log", [&] {
         const processors::passes::CacheWorkingSet set = processors::passes::working_set(trace, 1).caches[0];
         return set.ways.misses(shape.ways) == misses && set.distances.misses(full_lines) == full_misses;
       }});
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (Contestant& contestant : all) {
      const double begin = now();
      const bool same = contestant.pass();
      contestant.seconds = std::min(contestant.seconds, now() - begin);
      sim::ensure(same, "all simulators find the same misses");
    }
  }

  const double millions = static_cast<double>(lines.size()) / 1e6;
  std::printf("teapot:12, %u x %u, depth 2, one node: %.2f million references, %.2f %% misses\n", size, size,
              millions, 1e-4 * static_cast<double>(misses) / millions);
  const auto rate = [&](std::size_t number) { return millions / all[number].seconds; };
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::printf("%-26s %8.1f ms %8.1f M references/s %7.2f x plain\n", all[i].name.c_str(),
                1e3 * all[i].seconds, rate(i), rate(i) / rate(0));
  }
  using bench::against;
  report.add(against("tag store, 4 ways", "M refs/s", rate(1), "plain simulator", rate(0)));
  report.add(against("whole replay of one node", "M refs/s", rate(2), "plain simulator", rate(0)));
  report.add(
      against("misses of 1 to 16 ways, one pass", "M refs/s", rate(4), "plain simulator, 16 runs", rate(3)));
  report.add(against("misses of every LRU size, one pass", "M refs/s", rate(6), "list and hash table, 1 size",
                     rate(5)));
  report.add(against("both from the log", "M refs/s", rate(7), "plain simulator, 1 run", rate(0)));
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_caches", argc, argv, [](bench::Report& report, int count, char** values) {
        run(report, count > 1 ? static_cast<std::uint32_t>(std::atoi(values[1])) : 512U,
            std::max(1, count > 2 ? std::atoi(values[2]) : 5));
      });
}
