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
    if (links < many) [[likely]] {
      take_one_by_one(free_at_.data() + first, links, crossing);
    } else {
      take_many(free_at_.data() + first, links, crossing);
    }
  }

 private:
  // From so many links on, several at a time are faster than one by one.
  static constexpr std::uint32_t many = 12;

  static void take_one_by_one(std::uint64_t* free_at, std::size_t links, Crossing& crossing) {
    for (std::size_t link = 0; link < links; ++link) {
      const std::uint64_t begin = std::max(crossing.head, free_at[link]);
      free_at[link] = begin + crossing.held;
      crossing.head = begin + crossing.hop;
    }
  }
  static void take_many(std::uint64_t* free_at, std::size_t links, Crossing& crossing);

  sim::LargeVector<std::uint64_t> free_at_;
};

}  // namespace marti::memory
