// Keys of frames and machines, and checksums: a hash of what they are.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace marti::studies::sweep {

/// Values as bytes: a number has its own size, the lowest byte first; a text is its length in 64 bits and its
/// characters.
class ByteWriter {
 public:
  template <class... Values>
  ByteWriter& write(const Values&... values) {
    (put(values), ...);
    return *this;
  }
  [[nodiscard]] std::string take() { return std::exchange(bytes_, {}); }

 private:
  template <std::integral Number>
  void put(Number number) {
    for (std::size_t i = 0; i < sizeof number; ++i) {
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(number) >> (8 * i) & 0xffU);
    }
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    bytes_ += text;
  }

  std::string bytes_;
};

/// The 128-bit FNV-1a hash (Fowler, Noll, Vo; draft-eastlake-fnv, section 5) of a text in pieces. Among a
/// million different texts two are equal with a probability of about 1e-27.
class Digest {
 public:
  void add(std::string_view text) {
    constexpr Word prime = (Word{1} << 88U) + 0x13b;
    for (const char c : text) {
      word_ = (word_ ^ static_cast<unsigned char>(c)) * prime;
    }
  }
  /// 32 hexadecimal digits, most significant first.
  [[nodiscard]] std::string hex() const;
  /// Both halves in one number, as a checksum.
  [[nodiscard]] std::uint64_t folded() const { return high() ^ low(); }

 private:
  using Word = unsigned __int128;
  [[nodiscard]] std::uint64_t high() const { return static_cast<std::uint64_t>(word_ >> 64U); }
  [[nodiscard]] std::uint64_t low() const { return static_cast<std::uint64_t>(word_); }

  Word word_ = (Word{0x6c62272e07bb0142ULL} << 64U) + 0x62b821756295c58dULL;
};

}  // namespace marti::studies::sweep
