// When the links of a route become free, for messages that cross them one after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sim/large_pages.h"

namespace marti::memory {

/// The course of a message's head over links that it takes in a row: it leaves for the first one at `head`,
/// crosses each in `hop`, and each is taken for `held` from when it is free and the head is there. Times are
/// numbers modulo 2^64; those of a message whose arrival fits in 63 bits are right.
struct Crossing {
  std::uint64_t head = 0;
  std::uint64_t hop = 0;
  std::uint64_t held = 0;
};

class LinkTimes {
 public:
  /// All of `links` links are free.
  explicit LinkTimes(std::size_t links) : free_at_(links) {}

  /// A message takes `links` links that have consecutive numbers; at its end `crossing.head` is the time at
  /// which the head has crossed the last.
  [[gnu::always_inline]] void take(std::size_t first, std::uint32_t links, Crossing& crossing) {
    std::uint64_t* const free_at = free_at_.data() + first;
    for (std::uint32_t link = 0; link < links; ++link) {
      const std::uint64_t begin = std::max(crossing.head, free_at[link]);
      free_at[link] = begin + crossing.held;
      crossing.head = begin + crossing.hop;
    }
  }

 private:
  sim::LargeVector<std::uint64_t> free_at_;
};

}  // namespace marti::memory
