#include "processors/passes/one_pass.h"

#include <algorithm>
#include <optional>
#include <set>

#include "memory/all_ways.h"
#include "memory/stack_distance.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/packets_of_nodes.h"
#include "processors/walk/record_places.h"
#include "sim/error.h"

namespace marti::processors::passes {

namespace {

// A set with more ways than this is searched in a tree, not in a list.
constexpr std::uint32_t most_listed_ways = 64;

bool listed(const memory::CacheShape& shape) { return shape.sets > 1 || shape.ways <= most_listed_ways; }

// The passes for all shapes.
class Passes {
 public:
  explicit Passes(std::span<const memory::CacheShape> shapes) {
    std::set<std::uint32_t> sets;
    std::uint32_t ways = 0;
    for (const memory::CacheShape& shape : shapes) {
      if (listed(shape)) {
        sets.insert(shape.sets);
        ways = std::max(ways, shape.ways);
      } else if (!distances_) {
        distances_.emplace();
      }
    }
    if (!sets.empty()) {
      ways_.emplace(std::vector(sets.begin(), sets.end()), ways);
    }
  }

  [[gnu::always_inline]] void access(std::uint32_t line) {
    ++references_;
    if (ways_) {
      ways_->access(line);
    }
    if (distances_) {
      distances_->access(line);
    }
  }
  void empty_caches() {
    if (ways_) {
      ways_->clear();
    }
    if (distances_) {
      distances_->clear();
    }
  }
  [[nodiscard]] std::int64_t references() const { return references_; }
  [[nodiscard]] std::int64_t misses(const memory::CacheShape& shape) const {
    if (!listed(shape)) {
      return distances_->histogram().misses(shape.lines());
    }
    for (const memory::WaysHistogram& histogram : ways_->histograms()) {
      if (histogram.sets == shape.sets) {
        return histogram.misses(shape.ways);
      }
    }
    throw sim::InternalError("a cache was not passed");
  }

 private:
  std::int64_t references_ = 0;
  std::optional<memory::AllWays> ways_;
  std::optional<memory::StackDistances> distances_;
};

// Caches that count each line and report a hit, so that a walk never stops.
struct PassedCaches {
  static constexpr bool present = true;
  static constexpr bool by_kind = false;
  struct View {
    Passes* passes;
    [[gnu::always_inline]] bool access(memory::RecordKind /*kind*/, std::uint32_t line) const {
      passes->access(line);
      return true;
    }
  };
  [[nodiscard]] View view(std::uint32_t /*node*/) { return {&passes}; }

  Passes passes;
};

}  // namespace

OnePass one_pass(const program::WorkLog& log, const machine::MachineConfig& config,
                 std::span<const memory::CacheShape> shapes,
                 std::span<const std::vector<std::uint64_t>> packets_of_node) {
  sim::ensure(config.cache.organisation == machine::CacheOrganisation::unified &&
                  config.build.sharing == machine::Sharing::given,
              "one pass is for a unified cache and a given tree");
  for (const memory::CacheShape& shape : shapes) {
    sim::ensure(shape.sets > 0 && (1U << shape.line_shift) == config.cache.cache.line,
                "one pass is for caches of one line size");
  }
  machine::MachineConfig plain = config;  // every reference goes to the first level and no further
  plain.placement = machine::Placement::shared;
  plain.l2 = {};
  std::optional<walk::TreePlan> given;
  const memory::Layout layout = walk::layout_of(log, plain, given);
  const machine::PacketList packets(log.width, log.height, plain.packets);
  const std::vector<std::uint32_t> rank = walk::node_ranks(log, plain);
  const walk::ReplayInput input = {log, plain, layout, packets, rank};
  walk::LogWalker<PassedCaches> walker(input, PassedCaches{Passes(shapes)});
  OnePass pass;
  cost::NodeStatistics statistics;
  for (const std::vector<std::uint64_t>& numbers : packets_of_node) {
    walker.caches().passes.empty_caches();
    walk::for_each_pixel(input, numbers, [&](walk::Cursor& cursor, std::uint32_t, std::uint32_t) {
      pass.words += static_cast<std::uint64_t>(cursor.word_end - cursor.word);
      (void)walker.template advance<true>(0, cursor, statistics);
      walker.finish_pixel(0, cursor, statistics);
    });
  }
  pass.steps = statistics.steps;
  pass.references = walker.caches().passes.references();
  for (const memory::CacheShape& shape : shapes) {
    pass.misses.push_back(walker.caches().passes.misses(shape));
  }
  return pass;
}

std::vector<std::uint64_t> words_of_packets(const program::WorkLog& log,
                                            const machine::PacketConfig& config) {
  const machine::PacketList packets(log.width, log.height, config);
  std::vector<std::uint64_t> words(packets.size());
  for (std::uint64_t number = 0; number < packets.size(); ++number) {
    const machine::Packet packet = packets[number];
    for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
      words[number] += log.rows[y].begin[packet.x1] - log.rows[y].begin[packet.x0];
    }
  }
  return words;
}

}  // namespace marti::processors::passes
