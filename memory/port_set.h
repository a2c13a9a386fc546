// A set of ports that finds its next member in logarithmic time.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace marti::memory {

/// Bits in words of 64; each level above has a bit for each word of the level below that is not zero.
class PortSet {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  explicit PortSet(std::uint32_t ports) {
    std::size_t words = ports;
    do {
      words = (words + 63) / 64;
      levels_.emplace_back(words);
    } while (words > 1);
  }

  void insert(std::uint32_t port) {
    for (std::vector<std::uint64_t>& level : levels_) {
      level[port / 64] |= bit(port);
      port /= 64;
    }
  }
  void erase(std::uint32_t port) {
    for (std::vector<std::uint64_t>& level : levels_) {
      level[port / 64] &= ~bit(port);
      if (level[port / 64] != 0) {
        return;
      }
      port /= 64;
    }
  }
  [[nodiscard]] bool empty() const { return levels_.back()[0] == 0; }

  /// The lowest member that is at least `from`; `none` if there is no such member.
  [[nodiscard]] std::uint32_t at_or_after(std::uint32_t from) const {
    std::uint64_t at = from;
    std::size_t level = 0;
    for (;;) {
      if (level == levels_.size() || at / 64 >= levels_[level].size()) {
        return none;
      }
      const std::uint64_t rest = levels_[level][at / 64] >> (at % 64);
      if (rest != 0) {
        at += static_cast<std::uint64_t>(std::countr_zero(rest));
        break;
      }
      at = at / 64 + 1;
      ++level;
    }
    for (; level > 0; --level) {
      at = at * 64 + static_cast<std::uint64_t>(std::countr_zero(levels_[level - 1][at]));
    }
    return static_cast<std::uint32_t>(at);
  }

 private:
  static std::uint64_t bit(std::uint32_t port) { return std::uint64_t{1} << (port % 64); }

  std::vector<std::vector<std::uint64_t>> levels_;
};

}  // namespace marti::memory
