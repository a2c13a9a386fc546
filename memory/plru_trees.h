// Trees of bits for tree-PLRU replacement, one for each set of a cache.
//
// A set of 2^k ways has a binary tree of 2^k - 1 bits above its ways. Each bit says in which half below it
// the next victim lies. Using a way sets the bits on its path to point away from it. (So, R., Rechtschaffen,
// R., Cache operations by MRU change, IEEE Transactions on Computers 37(6), 1988; Al-Zoubi et al., ACM
// Southeast Regional Conference 2004, call it tree-based pseudo-LRU.)
//
// Removing a line leaves the bits unchanged, so it commutes with uses of other lines of the set.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/error.h"

namespace marti::memory {

class PlruTrees {
 public:
  PlruTrees(std::size_t sets, std::uint32_t ways, std::uint64_t /*seed*/)
      : ways_(ways), words_((ways + word_bits - 1) / word_bits), bits_(sets * words_) {}

  static void check(std::uint64_t ways) {
    if (!std::has_single_bit(ways)) {
      throw sim::UserError("tree-PLRU replacement needs sets of a power of two of ways, not of " +
                           std::to_string(ways));
    }
  }
  static std::uint64_t bytes_a_set(std::uint64_t ways) { return 8 + ways / 8; }

  void fill(std::size_t set, std::uint32_t way) { use(set, way); }
  void use(std::size_t set, std::uint32_t way) {
    std::uint64_t* const bits = bits_.data() + set * words_;
    // Numbered as a heap: the root is 1, below n are 2 n and 2 n + 1, and the ways follow the last bit.
    for (std::uint32_t below = ways_ + way; below > 1; below /= 2) {
      const std::uint32_t at = below / 2;
      const std::uint64_t bit = std::uint64_t{1} << (at % word_bits);
      std::uint64_t& word = bits[at / word_bits];
      word = below % 2 == 0 ? word | bit : word & ~bit;
    }
  }

  /// The way to which the bits point.
  [[nodiscard]] std::uint32_t victim(std::size_t set) const {
    const std::uint64_t* const bits = bits_.data() + set * words_;
    std::uint32_t at = 1;
    while (at < ways_) {
      at = 2 * at + static_cast<std::uint32_t>((bits[at / word_bits] >> (at % word_bits)) & 1U);
    }
    return at - ways_;
  }
  static constexpr bool counts_repeats = false;

 private:
  static constexpr std::uint32_t word_bits = 64;

  std::uint32_t ways_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace marti::memory
