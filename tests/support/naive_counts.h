// A second implementation of what is counted in detail, told of the references one by one: lists for fully
// associative caches, sets of all that a cache has had, a map of everything by what it was for.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "processors/replay/replay.h"
#include "processors/walk/node_caches.h"
#include "tests/support/naive_program.h"

namespace marti::test {

inline processors::machine::MachineConfig without_counting(processors::machine::MachineConfig machine) {
  machine.count = {};
  return machine;
}

class NaiveCounts {
 public:
  explicit NaiveCounts(const processors::machine::MachineConfig& machine)
      : machine_(machine), nodes_(machine.all_nodes()) {
    const memory::Address line = machine.cache.cache.line;
    for (std::size_t i = 0; i < processors::machine::split_caches; ++i) {
      lines_[i] = (machine.cache.organisation == processors::machine::CacheOrganisation::split
                       ? machine.cache.split_sizes[i]
                       : machine.cache.cache.size) /
                  line;
    }
  }

  /// A reference to a line of the node's cache number `cache`; of `action` only what it was for is used.
  /// `own`: no other node can have the line.
  void refer(std::uint32_t node, std::size_t cache, const NaiveAction& action, std::uint64_t line, bool hit,
             bool own = false) {
    ++cell(action)[0];
    Cache& seen = nodes_[node][cache];
    const bool in_full = use(seen.full, lines_[cache], line);
    if (hit) {
      return;
    }
    ++cell(action)[1];
    const bool taken = seen.taken.erase(line) != 0;
    const memory::MissClass why = seen.had.insert(line).second ? memory::MissClass::compulsory
                                  : taken                      ? memory::MissClass::invalidation
                                  : in_full                    ? memory::MissClass::conflict
                                                               : memory::MissClass::capacity;
    ++classes_[static_cast<std::size_t>(action.kind)][static_cast<std::size_t>(why)];
    if (!own) {
      fetch(node, line);
    }
  }
  /// Another node has written the line; `held`: the cache had it until then.
  void written(std::uint32_t node, std::size_t cache, std::uint64_t line, bool held) {
    Cache& seen = nodes_[node][cache];
    std::erase(seen.full, line);
    if (held) {
      seen.taken.insert(line);
    }
  }
  /// A prefetch: for what follows, the line was in the cache, but nobody has referred to it.
  void bring_in(std::uint32_t node, std::size_t cache, std::uint64_t line) {
    (void)use(nodes_[node][cache].full, lines_[cache], line);
    nodes_[node][cache].had.insert(line);
    nodes_[node][cache].taken.erase(line);
    fetch(node, line);
  }
  void second_level_hit(const NaiveAction& action) { ++cell(action)[2]; }
  void wait(const NaiveAction& action, sim::Ticks time) { cell(action)[3] += time; }

  /// Fails the test unless these are the counts; waits are compared where `waits`.
  void expect(const processors::walk::CacheCountResult& counts, bool waits) const {
    if (counts.miss_classes) {
      EXPECT_EQ(*counts.miss_classes, classes_);
    }
    if (counts.sharing) {
      std::map<std::uint32_t, std::int64_t> fetched;
      for (const auto& [line, nodes] : users_) {
        ++fetched[static_cast<std::uint32_t>(nodes.size())];
      }
      EXPECT_EQ(counts.sharing->fetches, fetches_);
      EXPECT_EQ(counts.sharing->distinct, static_cast<std::int64_t>(users_.size()));
      EXPECT_EQ(counts.sharing->fetched, fetched);
    }
    if (counts.attribution) {
      std::map<Key, Cell> cells;
      for (const processors::walk::AttributionRow& row : *counts.attribution) {
        cells[{row.bounce, static_cast<std::uint32_t>(row.ray), row.level,
               static_cast<std::size_t>(row.record), row.splitting}] = {
            row.counts.references, row.counts.misses, row.counts.second_level_hits,
            waits ? static_cast<std::int64_t>(row.counts.waited()) : 0};
      }
      std::map<Key, Cell> expected = cells_;
      for (auto& [key, cell] : expected) {
        cell[3] = waits ? cell[3] : 0;
      }
      // A wait of no ticks leaves an entry here, and none in the table.
      std::erase_if(expected, [](const auto& entry) { return entry.second == Cell{}; });
      EXPECT_EQ(cells, expected);
    }
  }

 private:
  // Bounce, ray, level, kind, whether to split a branch.
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::size_t, bool>;
  using Cell = std::array<std::int64_t, 4>;  // references, misses, second-level hits, waits
  struct Cache {
    std::vector<std::uint64_t> full;  // the lines of a fully associative cache, the newest first
    std::set<std::uint64_t> had;
    std::set<std::uint64_t> taken;  // by a write of another node, and not had since
  };

  static bool use(std::vector<std::uint64_t>& full, std::uint64_t lines, std::uint64_t line) {
    const auto at = std::find(full.begin(), full.end(), line);
    const bool there = at != full.end();
    if (there) {
      full.erase(at);
    }
    full.insert(full.begin(), line);
    if (full.size() > lines) {
      full.pop_back();
    }
    return there;
  }
  void fetch(std::uint32_t node, std::uint64_t line) {
    ++fetches_;
    users_[{node / machine_.nodes, line}].insert(node);
  }
  Cell& cell(const NaiveAction& action) {
    return cells_[{processors::program::bounce_of(action.ray),
                   static_cast<std::uint32_t>(processors::program::ray_kind_of(action.ray)), action.level,
                   static_cast<std::size_t>(action.kind), action.splitting}];
  }

  processors::machine::MachineConfig machine_;
  std::array<std::uint64_t, processors::machine::split_caches> lines_{};
  std::vector<std::array<Cache, processors::machine::split_caches>> nodes_;
  std::array<processors::walk::CacheCountResult::ByClass, memory::record_kinds> classes_{};
  std::map<Key, Cell> cells_;
  std::map<std::pair<std::uint32_t, std::uint64_t>, std::set<std::uint32_t>> users_;  // of (cluster, line)
  std::int64_t fetches_ = 0;
};

}  // namespace marti::test
