// The tags of one cache, written for plainness: each set is a list of its lines, each line has the set of its
// sectors that are there. All ways of replacing lines.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "memory/random_victims.h"

namespace marti::test {

class NaiveTags {
 public:
  /// `number`: of the cache among equal ones, which random replacement depends on.
  NaiveTags(const memory::CacheConfig& config, std::uint32_t number)
      : replacement_(config.replacement), shape_(memory::shape_of(config)), sets_(shape_.sets) {
    for (std::uint32_t set = 0; set < shape_.sets; ++set) {
      sets_[set].away.assign(shape_.ways, false);
      sets_[set].wait.assign(shape_.ways, 0);
      sets_[set].victims.emplace(config.seed, std::uint64_t{number} * shape_.sets + set);
    }
  }

  /// Whether the sector of the line is there; changes nothing.
  [[nodiscard]] bool holds(std::uint64_t line, std::uint64_t sector) const {
    for (const std::optional<Line>& there : sets_[line % shape_.sets].lines) {
      if (there && there->number == line) {
        return there->sectors.contains(sector);
      }
    }
    return false;
  }
  /// Whether it was there. It is then, as the most recent one.
  bool look_up(std::uint64_t line, std::uint64_t sector) {
    Set& set = sets_[line % shape_.sets];
    const bool hit = holds(line, sector);
    auto at = std::find_if(set.lines.begin(), set.lines.end(), [line](const std::optional<Line>& there) {
      return there && there->number == line;
    });
    if (at == set.lines.end()) {
      if (set.lines.size() < shape_.ways) {
        at = set.lines.insert(set.lines.end(), std::nullopt);
      } else {
        at = set.lines.begin() + victim(set);
      }
      *at = Line{line, {}};
      set.wait[static_cast<std::size_t>(at - set.lines.begin())] = 2;
      if (in_order()) {
        std::rotate(set.lines.begin(), at, at + 1);
        at = set.lines.begin();
      }
    } else if (replacement_ == memory::Replacement::lru) {
      std::rotate(set.lines.begin(), at, at + 1);
      at = set.lines.begin();
    } else {
      set.wait[static_cast<std::size_t>(at - set.lines.begin())] = 0;
    }
    (*at)->sectors.insert(sector);
    point_away(set, static_cast<std::size_t>(at - set.lines.begin()));
    return hit;
  }

 private:
  struct Line {
    std::uint64_t number;
    std::set<std::uint64_t> sectors;
  };
  struct Set {
    std::vector<std::optional<Line>> lines;  // lru and fifo: the newest first
    std::vector<bool> away;  // plru, by inner node of the tree: whether the right half is next
    std::vector<int> wait;   // srrip, by way: for how long nobody is expected to want it, 0 to 3
    std::optional<memory::VictimStream> victims;
  };

  [[nodiscard]] bool in_order() const {
    return replacement_ == memory::Replacement::lru || replacement_ == memory::Replacement::fifo;
  }
  std::ptrdiff_t victim(Set& set) const {
    if (in_order()) {
      return static_cast<std::ptrdiff_t>(shape_.ways) - 1;
    }
    if (replacement_ == memory::Replacement::random) {
      return set.victims->next(shape_.ways);
    }
    if (replacement_ == memory::Replacement::srrip) {
      while (std::find(set.wait.begin(), set.wait.end(), 3) == set.wait.end()) {
        for (int& each : set.wait) {
          ++each;
        }
      }
      return std::find(set.wait.begin(), set.wait.end(), 3) - set.wait.begin();
    }
    std::size_t first = 0;
    std::size_t node = 1;
    for (std::size_t half = shape_.ways / 2; half > 0; half /= 2) {
      const bool right = set.away[node];
      first += right ? half : 0;
      node = 2 * node + (right ? 1 : 0);
    }
    return static_cast<std::ptrdiff_t>(first);
  }
  void point_away(Set& set, std::size_t way) const {
    if (replacement_ != memory::Replacement::plru) {
      return;
    }
    std::size_t node = 1;
    for (std::size_t half = shape_.ways / 2; half > 0; half /= 2) {
      const bool right = way / half % 2 == 1;
      set.away[node] = !right;
      node = 2 * node + (right ? 1 : 0);
    }
  }

  memory::Replacement replacement_;
  memory::CacheShape shape_;
  std::vector<Set> sets_;
};

}  // namespace marti::test
