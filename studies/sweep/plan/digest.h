// Keys of frames and machines: a hash of what they are.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace marti::studies {

/// The 128-bit FNV-1a hash (Fowler, Noll, Vo; draft-eastlake-fnv, section 5) of a text in pieces. Among a
/// million different texts two are equal with a probability of about 1e-27.
class Digest {
 public:
  void add(std::string_view text);
  /// 32 hexadecimal digits, most significant first.
  [[nodiscard]] std::string hex() const;
  /// Both halves in one number, as a checksum.
  [[nodiscard]] std::uint64_t folded() const { return high_ ^ low_; }

 private:
  std::uint64_t high_ = 0x6c62272e07bb0142ULL;
  std::uint64_t low_ = 0x62b821756295c58dULL;
};

}  // namespace marti::studies
