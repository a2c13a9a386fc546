// The misses of set-associative LRU caches of all numbers of ways, for several numbers of sets, from one pass
// over the references.
//
// Within a set, LRU keeps the lines used last, so a cache of w ways misses a reference when at least w other
// lines of its set have been used since the line's last use (Mattson et al. 1970, see stack_distance.h; Hill
// and Smith, "Evaluating associativity in CPU caches", IEEE Trans. Computers 38(12), 1989, all-associativity
// simulation). When a number of sets divides a larger one, lines that share a set of the larger number share
// one of the smaller. So a line that was used last in its set of the smaller number was used last in its
// set of the larger one too, where a further use of it changes nothing (set refinement, ibid.).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "memory/set_tags.h"

namespace marti::memory {

/// The counts of a pass for one number of sets.
struct WaysHistogram {
  std::uint32_t sets = 0;
  std::int64_t references = 0;
  std::vector<std::int64_t> hits;  ///< [d]: references after d other lines of the set were used

  /// Misses of an LRU cache of so many ways, from 0 to hits.size().
  [[nodiscard]] std::int64_t misses(std::uint32_t ways) const;

  /// Both must have the same number of sets and of ways.
  WaysHistogram& operator+=(const WaysHistogram& other);
  friend bool operator==(const WaysHistogram&, const WaysHistogram&) = default;
};

/// One pass. Lines are numbers below 2^32 - 1; the set of a line is its number modulo the number of sets.
/// When more than `most_ways` lines were used since a line's last use, the reference counts as a miss of all
/// caches; so the time of a reference is at most proportional to `most_ways`.
class AllWays {
 public:
  /// Throws UserError for an empty list, for a number of sets that is 0 or given twice, for 0 ways, and for
  /// more than `most_lines` lines.
  AllWays(std::vector<std::uint32_t> set_counts, std::uint32_t most_ways);

  void access(std::uint32_t line) {
    ++references_;
    for (Forest& forest : forests_) {
      std::uint32_t* const tags = forest.tags.data() + std::size_t{forest.index(line)} * most_ways_;
      if (tags[0] == line) {
        ++forest.hits[0];
        if (forest.refined) {
          return;
        }
        continue;
      }
      std::uint32_t* const end = tags + most_ways_;
      std::uint32_t* at = std::find(tags + 1, end, line);
      if (at != end) {
        ++forest.hits[static_cast<std::size_t>(at - tags)];
      } else {
        --at;
      }
      std::copy_backward(tags, at, at + 1);
      tags[0] = line;
    }
  }

  /// Empties the caches, for the references of another node. The counts stay.
  void clear();

  /// One for each number of sets, in ascending order.
  [[nodiscard]] std::vector<WaysHistogram> histograms() const;

 private:
  struct Forest {
    std::uint32_t sets = 0;
    SetIndex index;
    bool refined = false;  // the number of sets divides all larger ones
    std::vector<std::uint32_t> tags;
    std::vector<std::int64_t> hits;  // without references that ended at a refined forest before
  };

  std::uint32_t most_ways_;
  std::int64_t references_ = 0;
  std::vector<Forest> forests_;
};

}  // namespace marti::memory
