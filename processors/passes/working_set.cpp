#include "processors/passes/working_set.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "processors/walk/law.h"
#include "processors/walk/log_walker.h"
#include "sim/key_error.h"

namespace marti::processors::passes {

namespace {

// The caches of one node, as configured.
std::vector<memory::CacheShape> shapes_of(const machine::NodeCacheConfig& config) {
  std::vector<memory::CacheShape> shapes;
  for (const machine::FirstLevelCache& first : machine::first_level_caches(config)) {
    shapes.push_back(memory::shape_of(first.cache));
  }
  return shapes;
}

std::uint32_t ways_counted(const memory::CacheShape& shape) { return std::max(shape.ways, counted_ways); }

// The lines of the cache whose ways are counted; a cache of one set needs none.
std::uint64_t lines_counted(const memory::CacheShape& shape) {
  return shape.sets > 1 ? std::uint64_t{shape.sets} * ways_counted(shape) : 0;
}

// The passes over the references to one cache.
class CachePass {
 public:
  explicit CachePass(const memory::CacheShape& shape) : shape_(shape) {
    if (shape.sets > 1) {
      ways_.emplace(std::vector{shape.sets}, ways_counted(shape));
    }
  }

  [[gnu::always_inline]] void access(std::uint32_t line) {
    distances_.access(line);
    if (ways_) {
      ways_->access(line);
    }
  }
  void empty_caches() {
    distances_.clear();
    if (ways_) {
      ways_->clear();
    }
  }
  [[nodiscard]] CacheWorkingSet result() const {
    return {shape_, distances_.histogram(), ways_ ? ways_->histograms()[0] : memory::WaysHistogram{}};
  }

 private:
  memory::CacheShape shape_;
  memory::StackDistances distances_;
  std::optional<memory::AllWays> ways_;
};

// Caches that count each line and report a hit, so that a walk never stops.
template <bool Split>
struct PassingCaches {
  static constexpr bool present = true;
  static constexpr bool by_kind = Split;
  struct View {
    std::vector<CachePass>* passes;
    [[gnu::always_inline]] bool access(memory::RecordKind kind, std::uint32_t line) const {
      (*passes)[Split ? walk::split_cache_of[static_cast<std::size_t>(kind)] : 0].access(line);
      return true;
    }
  };
  [[nodiscard]] View view(std::uint32_t /*node*/) { return {&passes}; }

  std::vector<CachePass> passes;
};

template <bool Split>
std::vector<CacheWorkingSet> walk_nodes(const walk::PacketsOfNodes& packets_of_nodes,
                                        const walk::ReplayInput& input, unsigned threads) {
  using Walker = walk::LogWalker<PassingCaches<Split>>;
  const std::vector<memory::CacheShape> shapes = shapes_of(input.config.cache);
  tbb::enumerable_thread_specific<Walker> walkers([&] {
    PassingCaches<Split> caches;
    for (const memory::CacheShape& shape : shapes) {
      caches.passes.emplace_back(shape);
    }
    return Walker(input, std::move(caches));
  });
  const auto walk = [&](std::uint32_t node) {
    Walker& walker = walkers.local();
    for (CachePass& pass : walker.caches().passes) {
      pass.empty_caches();
    }
    cost::NodeStatistics statistics;
    walk::for_each_pixel(input, packets_of_nodes.packets_of(node),
                         [&](walk::Cursor& cursor, std::uint32_t, std::uint32_t) {
                           (void)walker.template advance<true>(0, cursor, statistics);
                         });
  };
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute([&] { tbb::parallel_for(std::uint32_t{0}, packets_of_nodes.nodes(), walk); });

  // The sums are of integers, so it does not matter which thread had which nodes.
  std::vector<CacheWorkingSet> sum;
  for (Walker& walker : walkers) {
    const std::vector<CachePass>& passes = walker.caches().passes;
    for (std::size_t i = 0; i < passes.size(); ++i) {
      CacheWorkingSet part = passes[i].result();
      if (i == sum.size()) {
        sum.push_back(std::move(part));
      } else {
        sum[i].distances += part.distances;
        sum[i].ways += part.ways;
      }
    }
  }
  return sum;
}

bool packets_are_fixed(const machine::MachineConfig& config) {
  return config.all_nodes() == 1 || config.host.assignment != machine::Assignment::dynamic;
}

}  // namespace

void check_working_set(const machine::MachineConfig& config) {
  if (!config.count.working_set) {
    return;
  }
  if (config.scheme != machine::Scheme::image) {
    throw sim::KeyError("count.working_set", "the working set is told for machine.scheme = \"image\" only");
  }
  if (config.cache.organisation == machine::CacheOrganisation::none) {
    throw sim::KeyError(
        "count.working_set",
        "without a cache (cache.organisation) nodes read parts of lines, and there is no working set");
  }
  if (config.build.sharing != machine::Sharing::given) {
    throw sim::KeyError(
        "count.working_set",
        "the working set is told for build.sharing = \"given\" only: while the tree is built, other nodes "
        "decide what a node reads");
  }
  if (config.contexts > 1 || config.prefetch.on()) {
    throw sim::KeyError(
        "count.working_set",
        "with several contexts or prefetching (node.contexts, [prefetch]) the order in which a node refers "
        "to "
        "lines depends on its cache, so one pass cannot tell the misses of another cache");
  }
  if (config.kind == machine::NodeKind::simt) {
    throw sim::KeyError("count.working_set",
                        "in which order the lanes of a SIMT node refer to lines depends on its cache, so one "
                        "pass cannot tell the misses of another cache; use node.kind = \"core\"");
  }
  for (const memory::CacheShape& shape : shapes_of(config.cache)) {
    if (shape.sets > 1 && shape.ways > most_counted_ways) {
      throw sim::KeyError("count.working_set",
                          "the working set is told for caches of one set, or of sets of at most " +
                              std::to_string(most_counted_ways) + " ways, not " + std::to_string(shape.ways));
    }
    if (lines_counted(shape) > memory::most_lines) {
      throw sim::KeyError("count.working_set", "a set is told of with at least " +
                                                   std::to_string(counted_ways) +
                                                   " ways, and so the cache's " + std::to_string(shape.sets) +
                                                   " sets would have more than 2^28 lines");
    }
  }
}

std::uint64_t working_set_bytes(const machine::MachineConfig& config) {
  std::uint64_t bytes = 0;
  for (const memory::CacheShape& shape : shapes_of(config.cache)) {
    bytes += sizeof(std::uint32_t) * lines_counted(shape);
  }
  return config.count.working_set ? bytes : 0;
}

WorkingSet working_set(const walk::PacketsOfNodes& packets_of_nodes, unsigned threads) {
  const walk::ReplayInput input = packets_of_nodes.input(false);
  const bool split = input.config.cache.organisation == machine::CacheOrganisation::split;
  return {.line = input.config.cache.cache.line,
          .any_cache = packets_are_fixed(input.config),
          .caches = split ? walk_nodes<true>(packets_of_nodes, input, threads)
                          : walk_nodes<false>(packets_of_nodes, input, threads)};
}

void check_working_set(const WorkingSet& set, const machine::MachineConfig& config,
                       const replay::MachineResult& result) {
  const cost::ReferenceCounts counts = result.references();
  for (std::size_t i = 0; i < set.caches.size(); ++i) {
    std::int64_t references = 0;
    std::int64_t misses = 0;
    for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
      if (set.caches.size() == 1 || walk::split_cache_of[kind] == i) {
        references += counts.hits[kind] + counts.misses[kind];
        misses += counts.misses[kind];
      }
    }
    const CacheWorkingSet& cache = set.caches[i];
    walk::require_equal(cache.distances.references, references,
                        "one pass meets the references of the replay");
    walk::require(cache.shape.sets == 1 || cache.ways.references == references,
                  "the pass over all ways meets the references of the replay");
    if (config.cache.cache.replacement == memory::Replacement::lru) {
      walk::require_equal(cache.shape.sets == 1 ? cache.distances.misses(cache.shape.ways)
                                                : cache.ways.misses(cache.shape.ways),
                          misses, "one pass finds the misses of the replay");
    }
    walk::require(misses >= cache.distances.compulsory, "a cache misses at least the first uses of lines");
  }
}

}  // namespace marti::processors::passes
