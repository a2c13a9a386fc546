// How many entries of a lane's traversal stack are on chip, and how many lines of them in memory
// (docs/internals/rt-unit.md, Stacks in memory). What the entries are is known to LaneStack.
#pragma once

#include <algorithm>
#include <cstdint>

namespace marti::processors::simt {

class ShortStack {
 public:
  struct Size {
    std::uint32_t on_chip = 1;  ///< entries, at least 1
    std::uint32_t a_line = 1;   ///< entries that a line holds, at least 1
  };

  void clear() { *this = {}; }

  /// Pushes an entry. Where that fills a line, calls write(its number), from 0 on.
  template <class Write>
  void push(Size size, const Write& write) {
    if (on_chip_ < size.on_chip) {
      ++on_chip_;
    } else if (++gathered_ == size.a_line) {
      gathered_ = 0;
      write(lines_++);
    }
  }

  /// Pops entries, of which there must be so many. Returns how many lines must be read back for it: from
  /// number lines() + that - 1 down to number lines().
  [[nodiscard]] std::uint32_t pop(Size size, std::uint32_t entries) {
    const std::uint32_t from_chip = std::min(entries, on_chip_);
    on_chip_ -= from_chip;
    entries -= from_chip;
    const std::uint32_t from_line = std::min(entries, gathered_);
    gathered_ -= from_line;
    entries -= from_line;
    const std::uint32_t read = (entries + size.a_line - 1) / size.a_line;
    if (read > 0) {
      lines_ -= read;
      gathered_ = read * size.a_line - entries;
    }
    return read;
  }

  /// Lines in memory.
  [[nodiscard]] std::uint32_t lines() const { return lines_; }
  /// Entries that are not in memory: on chip, or in the line that is being filled.
  [[nodiscard]] std::uint32_t near() const { return on_chip_ + gathered_; }

 private:
  std::uint32_t on_chip_ = 0;   // the newest entries
  std::uint32_t gathered_ = 0;  // those that were pushed out of these and fill no line yet
  std::uint32_t lines_ = 0;
};

}  // namespace marti::processors::simt
