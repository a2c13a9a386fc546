// A set of small numbers in which the next member is found in constant time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace marti::sim {

/// Of numbers below 64^3. Three levels of bits: a bit of a level says whether 64 bits of the level below are
/// not 0.
class NumberSet {
 public:
  static constexpr std::uint32_t most = 64U * 64 * 64;

  /// Empty, for numbers below `size`, at most `most`.
  explicit NumberSet(std::uint32_t size) : low_((size + 63) / 64), middle_((low_.size() + 63) / 64) {}

  [[gnu::always_inline]] void insert(std::uint32_t number) {
    low_[number / 64] |= bit(number);
    middle_[number / 4096] |= bit(number / 64);
    high_ |= bit(number / 4096);
  }
  [[gnu::always_inline]] void erase(std::uint32_t number) {
    if ((low_[number / 64] &= ~bit(number)) == 0 && (middle_[number / 4096] &= ~bit(number / 64)) == 0) {
      high_ &= ~bit(number / 4096);
    }
  }
  /// The least member from `number` on; if all are less, the least of all. The set must not be empty.
  [[nodiscard]] [[gnu::always_inline]] std::uint32_t next(std::uint32_t number) const {
    const std::uint64_t word = low_[number / 64] & from(number);
    return word != 0 ? number / 64 * 64 + first(word) : next_in_other_word(number);
  }

 private:
  [[nodiscard]] [[gnu::noinline]] std::uint32_t next_in_other_word(std::uint32_t number) const {
    if (const std::uint64_t word = middle_[number / 4096] & from(number / 64) & ~bit(number / 64);
        word != 0) {
      return in_word(number / 4096 * 64 + first(word));
    }
    const std::uint64_t word = high_ & from(number / 4096) & ~bit(number / 4096);
    const std::uint32_t at = first(word != 0 ? word : high_);
    return in_word(at * 64 + first(middle_[at]));
  }
  static std::uint64_t bit(std::uint32_t number) { return std::uint64_t{1} << (number % 64); }
  static std::uint64_t from(std::uint32_t number) { return ~std::uint64_t{0} << (number % 64); }
  static std::uint32_t first(std::uint64_t word) {
    return static_cast<std::uint32_t>(std::countr_zero(word));
  }
  [[nodiscard]] std::uint32_t in_word(std::uint32_t word) const { return word * 64 + first(low_[word]); }

  std::vector<std::uint64_t> low_;
  std::vector<std::uint64_t> middle_;
  std::uint64_t high_ = 0;
};

}  // namespace marti::sim
