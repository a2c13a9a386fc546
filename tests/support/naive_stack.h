// A ray's traversal stack, part of which is in memory, written for plainness from docs/internals/rt-unit.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace marti::test {

class NaiveStack {
 public:
  /// `on_chip`: entries, 0 for any number. `a_line`: entries that a line has room for.
  NaiveStack(std::size_t on_chip, std::size_t a_line) : on_chip_(on_chip), a_line_(a_line) { nearest = 0; }

  std::optional<std::uint32_t> nearest;  ///< the entry that is taken next; at first the root
  std::vector<std::size_t> written;      ///< numbers of lines, since somebody has cleared it
  std::vector<std::size_t> read;

  void push(std::uint32_t entry) {
    chip_.push_back(entry);
    if (on_chip_ == 0 || chip_.size() <= on_chip_) {
      return;
    }
    line_.push_back(chip_.front());
    chip_.pop_front();
    if (line_.size() == a_line_) {
      written.push_back(memory_.size());
      memory_.push_back(std::exchange(line_, {}));
    }
  }

  /// Takes the next entry; none is left: null.
  std::optional<std::uint32_t> take() {
    if (nearest) {
      return std::exchange(nearest, std::nullopt);
    }
    if (chip_.empty() && line_.empty() && !memory_.empty()) {
      line_ = memory_.back();
      memory_.pop_back();
      read.push_back(memory_.size());
    }
    std::optional<std::uint32_t> entry;
    if (!chip_.empty()) {
      entry = chip_.back();
      chip_.pop_back();
    } else if (!line_.empty()) {
      entry = line_.back();
      line_.pop_back();
    }
    return entry;
  }

  /// The entries that are not in memory, the next one first.
  [[nodiscard]] std::vector<std::uint32_t> near() const {
    std::vector<std::uint32_t> entries(chip_.rbegin(), chip_.rend());
    entries.insert(entries.end(), line_.rbegin(), line_.rend());
    return entries;
  }

 private:
  std::size_t on_chip_;
  std::size_t a_line_;
  std::deque<std::uint32_t> chip_;  // the oldest first
  std::vector<std::uint32_t> line_;
  std::vector<std::vector<std::uint32_t>> memory_;
};

}  // namespace marti::test
