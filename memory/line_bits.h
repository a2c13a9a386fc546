// A set of lines that takes host memory as far as the highest line in it.
#pragma once

#include <cstdint>
#include <vector>

namespace marti::memory {

class LineBits {
 public:
  /// Inserts a line; true when it was not in the set.
  bool insert(std::uint32_t line) {
    if (line / 64 >= words_.size()) {
      words_.resize(line / 64 + 1);
    }
    std::uint64_t& word = words_[line / 64];
    const std::uint64_t bit = std::uint64_t{1} << (line % 64);
    const bool added = (word & bit) == 0;
    word |= bit;
    return added;
  }
  /// Removes a line; true when it was in the set.
  bool erase(std::uint32_t line) {
    if (line / 64 >= words_.size()) {
      return false;
    }
    std::uint64_t& word = words_[line / 64];
    const std::uint64_t bit = std::uint64_t{1} << (line % 64);
    const bool there = (word & bit) != 0;
    word &= ~bit;
    return there;
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace marti::memory
