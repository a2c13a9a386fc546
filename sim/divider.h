// Division of many numbers by one divisor.
#pragma once

#include <bit>
#include <cstdint>

namespace marti::sim {

/// Divides by a multiplication and a shift, several times as fast as a division whose divisor the compiler
/// does not know (T. Granlund, P. L. Montgomery, "Division by invariant integers using multiplication", PLDI
/// 1994, theorem 4.2 with N = 62).
class Divider {
 public:
  /// From 1 to 2^62.
  explicit constexpr Divider(std::uint64_t divisor)
      : shift_(62U + static_cast<unsigned>(std::bit_width(divisor - 1))),
        factor_(static_cast<std::uint64_t>(((Wide{1} << shift_) + divisor - 1) / divisor)) {}

  /// The quotient, rounded down, of a number below 2^62.
  [[nodiscard]] constexpr std::uint64_t operator()(std::uint64_t number) const {
    return static_cast<std::uint64_t>((Wide{number} * factor_) >> shift_);
  }

 private:
  __extension__ using Wide = unsigned __int128;

  unsigned shift_;
  std::uint64_t factor_;
};

}  // namespace marti::sim
