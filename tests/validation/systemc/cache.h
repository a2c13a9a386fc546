// A private cache as docs/model.md describes it, by the plainest means: a list for each set.
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
      sets_[set].draws = config.seed + (cache * sets_.size() + set) * 0xd1342543de82ef95ULL;
    }
  }

  /// Whether the line is there. It is afterwards.
  bool look_up(std::uint64_t line) {
    Set& set = sets_[line % sets_.size()];
    const auto found = std::find(set.lines.begin(), set.lines.end(), line);
    if (found != set.lines.end()) {
      if (replacement_ == memory::Replacement::lru) {
        set.lines.splice(set.lines.end(), set.lines, found);
      }
      return true;
    }
    if (set.lines.size() < ways_) {
      set.lines.push_back(line);
    } else if (replacement_ == memory::Replacement::random) {
      *std::next(set.lines.begin(), static_cast<std::ptrdiff_t>(draw(set))) = line;
    } else {
      set.lines.pop_front();
      set.lines.push_back(line);
    }
    return false;
  }

 private:
  /// Lines in the order of their last use (lru), of their coming in (fifo), or way by way (random).
  struct Set {
    std::list<std::uint64_t> lines;
    std::uint64_t draws = 0;
  };

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
