#include "studies/sweep/plan/digest.h"

namespace marti::studies {

void Digest::add(std::string_view text) {
  // The prime is 2^88 + 0x13b.
  constexpr std::uint64_t factor = 0x13b;
  constexpr unsigned shift = 88 - 64;
  constexpr std::uint64_t half = 0xffffffffULL;
  std::uint64_t high = high_;
  std::uint64_t low = low_;
  for (const char c : text) {
    low ^= static_cast<unsigned char>(c);
    const std::uint64_t lower = (low & half) * factor;
    const std::uint64_t upper = (low >> 32U) * factor + (lower >> 32U);
    high = high * factor + (upper >> 32U) + (low << shift);
    low = (upper << 32U) | (lower & half);
  }
  high_ = high;
  low_ = low;
}

std::string Digest::hex() const {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint64_t word : {high_, low_}) {
    for (int nibble = 15; nibble >= 0; --nibble) {
      text += digits[(word >> (4 * static_cast<unsigned>(nibble))) & 15U];
    }
  }
  return text;
}

}  // namespace marti::studies
