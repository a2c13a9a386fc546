// Lines in the order of their last use, with the number of lines used since a given one.
//
// Each use has a time stamp, and each stamp has a bit that is set if it is the last one of its line. The
// number of lines used since a stamp is the number of set bits behind it. Bits are counted by words of 64, by
// 4 words, by blocks of 16 words, and from there on by groups of 16 of the level below. A sum therefore takes
// a part of one group of each level, and needs no levels above the one where that group is also the newest.
// The bits of a word are set in advance when its first stamp is used, and a block is counted in the levels
// above when all its stamps are used, so that a use does not have to update them. When all stamps are used
// up, the lines get new stamps in the same order.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace marti::memory {

class RecencyTree {
 public:
  static constexpr std::uint32_t absent = 0xffffffffU;

  RecencyTree();

  /// Returns how many other lines have been used since the last use of `line`, or `absent` when it has never
  /// been used. Makes it the newest one.
  [[gnu::always_inline]] std::uint32_t use(std::uint32_t line) {
    if (next_ % 64 == 0) [[unlikely]] {
      begin_word();
    }
    std::uint32_t& stamp_plus_one = stamp_of(line);
    const std::uint32_t now = next_++;
    const std::uint32_t old = stamp_plus_one - 1;
    stamp_plus_one = now + 1;
    line_of_[now] = line;
    if (old == absent) [[unlikely]] {
      ++lines_;
      return absent;
    }
    std::uint32_t newer = newer_in_block(old);
    if ((old >> block_bits) != (now >> block_bits)) {
      newer += leave_block(old >> block_bits, now >> block_bits);
    }
    clear(old);
    return newer - (64 - now % 64);  // without the bits from now on
  }

  /// Number of lines that have been used.
  [[nodiscard]] std::uint32_t lines() const { return lines_; }

  /// Forgets all uses.
  void clear();

 private:
  static constexpr unsigned word_bits = 6;
  static constexpr unsigned block_bits = word_bits + 4;
  static constexpr unsigned group_bits = 4;
  static constexpr std::uint32_t group = 1U << group_bits;
  static constexpr unsigned page_bits = 10;
  using Page = std::array<std::uint32_t, 1U << page_bits>;

  // The bits of 1,024 stamps, and counts of them, four 16-bit ones to a word: by words and by four words.
  struct alignas(8) Block {
    std::array<std::uint64_t, 16> words{};
    std::array<std::uint64_t, 4> of_words{};
    std::uint64_t of_fours = 0;
  };
  static std::uint64_t lane(std::uint32_t index) { return std::uint64_t{1} << (16 * (index % 4)); }
  // The sum of the counts after that of `index`.
  static std::uint32_t behind(std::uint64_t counts, std::uint32_t index) {
    return static_cast<std::uint32_t>(((counts >> 16U >> (16 * (index % 4))) * 0x0001000100010001U) >> 48U);
  }
  // std::popcount without its function call on processors that may lack the instruction.
  static std::uint32_t bits_of(std::uint64_t word) {
    word -= (word >> 1U) & 0x5555555555555555U;
    word = (word & 0x3333333333333333U) + ((word >> 2U) & 0x3333333333333333U);
    word = (word + (word >> 4U)) & 0x0f0f0f0f0f0f0f0fU;
    return static_cast<std::uint32_t>((word * 0x0101010101010101U) >> 56U);
  }

  [[nodiscard]] std::uint32_t newer_in_block(std::uint32_t stamp) const {
    const Block& block = here_[stamp >> block_bits];
    const std::uint32_t word = (stamp >> word_bits) % 16;
    return bits_of(block.words[word] >> (stamp % 64) >> 1U) + behind(block.of_words[word / 4], word) +
           behind(block.of_fours, word / 4);
  }
  void clear(std::uint32_t stamp) {
    Block& block = here_[stamp >> block_bits];
    const std::uint32_t word = (stamp >> word_bits) % 16;
    block.words[word] &= ~(std::uint64_t{1} << (stamp % 64));
    block.of_words[word / 4] -= lane(word);
    block.of_fours -= lane(word / 4);
  }

  [[nodiscard]] std::uint32_t& stamp_of(std::uint32_t line) {
    const std::size_t page = line >> page_bits;
    if (page >= pages_.size() || pages_[page] == nullptr) [[unlikely]] {
      add_page(page);
    }
    return (*pages_[page])[line % (1U << page_bits)];
  }

  void add_page(std::size_t page);
  static std::uint32_t bits_of(const Block& block) {
    return static_cast<std::uint32_t>((block.of_fours * 0x0001000100010001U) >> 48U);
  }
  // Call it before the first stamp of a word is used.
  void begin_word();
  // Counts off a bit in `block`, a block before the current one, `now`; returns the bits behind `block`.
  std::uint32_t leave_block(std::uint32_t block, std::uint32_t now);
  void size_for(std::uint32_t stamps);
  void stamp_anew();
  template <class Use>
  void for_each_here(const Use& use) const;

  std::uint32_t stamps_ = 0;  // number of stamps
  std::uint32_t next_ = 0;    // the first stamp not used yet
  std::uint32_t lines_ = 0;
  std::vector<Block> here_;
  std::vector<std::vector<std::uint32_t>> blocks_;  // bits of blocks, of 16 blocks, and so on
  std::vector<std::uint32_t> line_of_;              // by stamp
  // For each line its last stamp + 1, or 0. Pages exist only for ranges of line numbers that have been used.
  std::vector<std::unique_ptr<Page>> pages_;
};

}  // namespace marti::memory
