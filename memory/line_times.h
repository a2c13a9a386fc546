// When the links of long lines become free, for messages that cross many of them one after the other.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "memory/link_times.h"
#include "sim/large_pages.h"

namespace marti::memory {

/// As LinkTimes, for links of which a message takes many in a row. Of the links that a message has crossed
/// without waiting each is free a hop after the one before, until another message takes some of them. So
/// links are kept in pieces of links in a row, and of each piece the time of its first link. A message leaves
/// one piece behind, and one more for each link at which it has waited; it takes as long as there are pieces
/// on its way. (In a mesh of 65,536 nodes these are 4 of the 82 links that a message takes of a row or
/// column.)
class LineTimes {
 public:
  /// All of `links` links are free. Every crossing has this hop.
  LineTimes(std::size_t links, std::uint64_t hop)
      : hop_(hop), free_at_(links + 1), begins_(links / 64 + 1, ~std::uint64_t{0}) {}

  /// Bytes of host memory for so many links.
  [[nodiscard]] static std::uint64_t bytes(std::uint64_t links) {
    return (links + 1) * sizeof(std::uint64_t) + (links / 64 + 1) * sizeof(std::uint64_t);
  }

  /// As LinkTimes::take().
  [[gnu::always_inline]] void take(std::size_t first, std::uint32_t links, Crossing& crossing) {
    if (links != 0) {
      take_pieces(first, first + links, crossing);
    }
  }

 private:
  // Without branches that depend on times: whether a message waits is not predictable.
  void take_pieces(std::size_t first, std::size_t end, Crossing& crossing) {
    const std::size_t piece = piece_of(first);
    std::size_t at = first;  // a piece as it was begins here, or the message's first link is within it
    std::uint64_t free_at = free_at_[piece] + (first - piece) * hop_;
    std::uint64_t head = std::max(crossing.head, free_at);
    free_at_[first] = head + crossing.held;
    begins_[first / 64] |= bit(first);
    for (std::size_t word = first / 64; word <= (end - 1) / 64; ++word) {
      const std::uint64_t within =
          (word == first / 64 ? ~std::uint64_t{1} << (first % 64) : ~std::uint64_t{0}) &
          (word == (end - 1) / 64 ? ~std::uint64_t{0} >> (63 - (end - 1) % 64) : ~std::uint64_t{0});
      std::uint64_t begun = begins_[word];
      for (std::uint64_t left = begun & within; left != 0; left &= left - 1) {
        const auto place = static_cast<unsigned>(std::countr_zero(left));
        const std::size_t next = 64 * word + place;
        head += (next - at) * hop_;
        at = next;
        free_at = free_at_[at];
        begun ^= std::uint64_t{free_at <= head} << place;
        head = std::max(head, free_at);
        free_at_[at] = head + crossing.held;
      }
      begins_[word] = begun;
    }
    crossing.head = head + (end - at) * hop_;
    free_at_[end] = begins(end) ? free_at_[end] : free_at + (end - at) * hop_;
    begins_[end / 64] |= bit(end);
  }

  [[nodiscard]] static std::uint64_t bit(std::size_t link) { return std::uint64_t{1} << (link % 64); }
  [[nodiscard]] bool begins(std::size_t link) const { return (begins_[link / 64] & bit(link)) != 0; }
  // The link with which the piece of `link` begins.
  [[nodiscard]] std::size_t piece_of(std::size_t link) const {
    std::size_t word = link / 64;
    std::uint64_t bits = begins_[word] & (~std::uint64_t{0} >> (63 - link % 64));
    while (bits == 0) {
      bits = begins_[--word];
    }
    return 64 * word + 63 - static_cast<std::size_t>(std::countl_zero(bits));
  }
  std::uint64_t hop_;
  sim::LargeVector<std::uint64_t> free_at_;  // of links with which a piece begins
  std::vector<std::uint64_t> begins_;        // a bit for each link: whether a piece begins with it
};

}  // namespace marti::memory
