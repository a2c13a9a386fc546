// A private cache as docs/internals/model.md describes it, by the plainest means: a list for each set.
#pragma once

#include <algorithm>
#include <cstdint>
#include <list>
#include <vector>

#include "memory/cache_config.h"

namespace marti::oracle {

class NaiveCache {
 public:
  /// Cache number `cache` of equal ones, of `size` bytes.
  NaiveCache(const memory::CacheConfig& config, std::uint64_t size, std::uint64_t cache)
      : ways_(config.ways == memory::full_ways ? size / config.line : config.ways),
        replacement_(config.replacement),
        sets_(size / config.line / ways_) {
    for (std::uint64_t set = 0; set < sets_.size(); ++set) {
      sets_[set].points_right.resize(config.replacement == memory::Replacement::plru ? ways_ : 0);
      sets_[set].distance.resize(config.replacement == memory::Replacement::srrip ? ways_ : 0);
      sets_[set].draws = config.seed + (cache * sets_.size() + set) * 0xd1342543de82ef95ULL;
    }
  }

  /// Whether the cache holds the line; brings it in if not.
  bool look_up(std::uint64_t line) {
    Set& set = sets_[line % sets_.size()];
    const auto found = std::find(set.lines.begin(), set.lines.end(), line);
    if (found != set.lines.end()) {
      if (replacement_ == memory::Replacement::lru) {
        set.lines.splice(set.lines.end(), set.lines, found);
      } else if (replacement_ == memory::Replacement::plru) {
        turn_away(set, static_cast<std::uint64_t>(std::distance(set.lines.begin(), found)));
      } else if (replacement_ == memory::Replacement::srrip) {
        set.distance[static_cast<std::size_t>(std::distance(set.lines.begin(), found))] = 0;
      }
      return true;
    }
    bring_in(set, line);
    return false;
  }

 private:
  /// Lines in the order of their last use (lru), of their coming in (fifo), or way by way (others).
  struct Set {
    std::list<std::uint64_t> lines;
    std::uint64_t draws = 0;         ///< random: the state of the stream
    std::vector<int> distance;       ///< srrip: of each way, 3 at most
    std::vector<bool> points_right;  ///< plru: each node of the tree; the root is 1, below n are 2 n, 2 n + 1
  };

  void bring_in(Set& set, std::uint64_t line) const {
    std::uint64_t way = set.lines.size();
    if (way < ways_) {
      set.lines.push_back(line);
    } else if (replacement_ != memory::Replacement::lru && replacement_ != memory::Replacement::fifo) {
      way = replacement_ == memory::Replacement::random  ? draw(set)
            : replacement_ == memory::Replacement::srrip ? most_distant(set)
                                                         : pointed_at(set);
      *std::next(set.lines.begin(), static_cast<std::ptrdiff_t>(way)) = line;
    } else {
      set.lines.pop_front();
      set.lines.push_back(line);
    }
    if (replacement_ == memory::Replacement::plru) {
      turn_away(set, way);
    } else if (replacement_ == memory::Replacement::srrip) {
      set.distance[way] = 2;
    }
  }

  // All move away by one until the first is at 3.
  static std::uint64_t most_distant(Set& set) {
    for (;;) {
      for (std::uint64_t way = 0; way < set.distance.size(); ++way) {
        if (set.distance[way] == 3) {
          return way;
        }
      }
      for (int& each : set.distance) {
        ++each;
      }
    }
  }

  // The ways are the leaves of the tree: ways_ + way.
  std::uint64_t pointed_at(const Set& set) const {
    std::uint64_t node = 1;
    while (node < ways_) {
      node = 2 * node + (set.points_right[node] ? 1 : 0);
    }
    return node - ways_;
  }
  void turn_away(Set& set, std::uint64_t way) const {
    for (std::uint64_t node = ways_ + way; node > 1; node /= 2) {
      set.points_right[node / 2] = node % 2 == 0;
    }
  }

  // SplitMix64, and the high half of a product as the way.
  std::uint64_t draw(Set& set) const {
    set.draws += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = set.draws;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    z = z ^ (z >> 31U);
    return ((z >> 32U) * ways_) >> 32U;
  }

  std::uint64_t ways_;
  memory::Replacement replacement_;
  std::vector<Set> sets_;
};

}  // namespace marti::oracle
