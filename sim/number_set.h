// A set of small numbers in which the next member is found in constant time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace marti::sim {

/// Of numbers below 64^2, in two levels of bits: a bit of the upper one says whether 64 bits of the lower one
/// are not 0.
class NumberSet {
 public:
  static constexpr std::uint32_t most = 64U * 64;

  [[gnu::always_inline]] void insert(std::uint32_t number) {
    low_[number / 64] |= bit(number);
    high_ |= bit(number / 64);
  }
  [[gnu::always_inline]] void erase(std::uint32_t number) {
    if ((low_[number / 64] &= ~bit(number)) == 0) {
      high_ &= ~bit(number / 64);
    }
  }
  /// The least member from `number` on; if all are less, the least of all. The set must not be empty.
  [[nodiscard]] [[gnu::always_inline]] std::uint32_t next(std::uint32_t number) const {
    const std::uint64_t word = low_[number / 64] & from(number);
    return word != 0 ? number / 64 * 64 + first(word) : next_in_other_word(number);
  }

 private:
  [[nodiscard]] [[gnu::noinline]] std::uint32_t next_in_other_word(std::uint32_t number) const {
    const std::uint64_t later = high_ & from(number / 64) & ~bit(number / 64);
    const std::uint32_t word = first(later != 0 ? later : high_);
    return word * 64 + first(low_[word]);
  }
  static std::uint64_t bit(std::uint32_t number) { return std::uint64_t{1} << (number % 64); }
  static std::uint64_t from(std::uint32_t number) { return ~std::uint64_t{0} << (number % 64); }
  static std::uint32_t first(std::uint64_t word) {
    return static_cast<std::uint32_t>(std::countr_zero(word));
  }

  std::array<std::uint64_t, 64> low_{};
  std::uint64_t high_ = 0;
};

}  // namespace marti::sim
