// The distances between uses of each line, hence the misses of LRU caches of every size, from one pass.
//
// The distance of a reference is the number of other lines used since the last use of its line. A fully
// associative LRU cache holds the lines used last, so a cache of any number of lines misses a reference
// exactly when the distance is at least that number (Mattson, Gecsei, Slutz, Traiger, "Evaluation techniques
// for storage hierarchies", IBM Systems Journal 9(2), 1970).
//
// Distances are counted in a tree over time stamps (Bennett and Kruskal, "LRU stack processing", IBM J. Res.
// Dev. 19(4), 1975; Olken, "Efficient methods for calculating the success function of fixed space replacement
// policies", LBL-12370, 1981), in a time that grows with the logarithm of the time since the last use.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/recency_tree.h"
#include "memory/set_tags.h"

namespace marti::memory {

/// The counts of a pass.
struct StackHistogram {
  std::int64_t references = 0;
  std::int64_t compulsory = 0;     ///< first uses of a line; every cache misses them
  std::vector<std::int64_t> hits;  ///< [d]: references at distance d; the last is not 0

  /// Misses of a fully associative LRU cache of so many lines. Takes time proportional to `lines`.
  [[nodiscard]] std::int64_t misses(std::uint64_t lines) const;
  /// The smallest cache, in lines, with at most `most_misses` misses, which must not be below `compulsory`.
  [[nodiscard]] std::uint64_t lines_for(std::int64_t most_misses) const;
  /// The smallest cache, in lines, that misses only first uses.
  [[nodiscard]] std::uint64_t enough() const { return hits.size(); }

  StackHistogram& operator+=(const StackHistogram& other);
  friend bool operator==(const StackHistogram&, const StackHistogram&) = default;
};

/// One pass. Lines are numbers below 2^32 - 1. Takes host memory in proportion to the lines in use (30 to
/// 50 bytes each when their numbers lie close together), however many references there are.
class StackDistances {
 public:
  void access(std::uint32_t line) {
    if (line == newest_) {
      ++repeats_;
      return;
    }
    newest_ = line;
    const std::uint32_t distance = order_.use(line);
    if (distance != RecencyTree::absent) [[likely]] {
      ++hits_[distance];
    } else {
      first_use();
    }
  }

  /// Empties the cache, for the references of another node. The counts stay.
  void clear();

  [[nodiscard]] StackHistogram histogram() const;

 private:
  void first_use();

  RecencyTree order_;
  std::uint32_t newest_ = no_line;
  std::int64_t repeats_ = 0;  // at distance 0
  std::int64_t compulsory_ = 0;
  std::vector<std::int64_t> hits_;  // [d]: at distance d; one for each line used
};

}  // namespace marti::memory
