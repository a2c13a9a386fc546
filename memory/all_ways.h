// The misses of set-associative LRU caches of all numbers of ways from one pass, for several numbers of sets
// at once.
//
// Within a set, LRU keeps the lines used last, so a cache of w ways misses a reference when at least w other
// lines of its set have been used since its line was (Mattson et al. 1970, see stack_distance.h; Hill and
// Smith, "Evaluating associativity in CPU caches", IEEE Trans. Computers 38(12), 1989, all-associativity
// simulation). When one number of sets divides another, lines that share a set of the second share one of the
// first; what is the newest line of its set of the first is it in the second's, too, and nothing moves there
// (set refinement, there).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "memory/set_tags.h"

namespace marti::memory {

/// What became of all references of a pass, for one number of sets.
struct WaysHistogram {
  std::uint32_t sets = 0;
  std::int64_t references = 0;
  std::vector<std::int64_t> hits;  ///< [d]: references with d other lines of the set since the last use

  /// Misses of an LRU cache of so many ways, 0 to hits.size().
  [[nodiscard]] std::int64_t misses(std::uint32_t ways) const;

  /// Both must be of the same number of sets and ways.
  WaysHistogram& operator+=(const WaysHistogram& other);
  friend bool operator==(const WaysHistogram&, const WaysHistogram&) = default;
};

/// One pass. Lines are numbers below 2^32 - 1; the set of a line is its number modulo the number of sets.
/// A reference with more than `most_ways` lines before it is only known to miss in all caches, so the time of
/// one is at most in proportion to `most_ways`.
class AllWays {
 public:
  /// Throws UserError without a number of sets, for a number that is 0 or given twice, for no way, and for
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

  /// The same caches, empty: the references that follow are another node's. What is counted stays.
  void forget();

  /// One for each number of sets, in ascending order.
  [[nodiscard]] std::vector<WaysHistogram> histograms() const;

 private:
  struct Forest {
    std::uint32_t sets = 0;
    SetIndex index;
    bool refined = false;  // the number of sets divides all later ones
    std::vector<std::uint32_t> tags;
    std::vector<std::int64_t> hits;  // those that a refined one before it has taken are not in it
  };

  std::uint32_t most_ways_;
  std::int64_t references_ = 0;
  std::vector<Forest> forests_;
};

}  // namespace marti::memory
