// The lines that a node has under way, each in a register, and what waits for them. After Kroft, Lockup-free
// instruction fetch/prefetch cache organization, ISCA 1981.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "memory/record_kind.h"
#include "processors/walk/attribution.h"

namespace marti::processors::simt {

class LineRegisters {
 public:
  /// A line of one of the node's caches: the number of the cache, then in the lower 32 bits that of the line.
  using Key = std::uint64_t;

  struct Register {
    bool left = false;                                   ///< the line was asked for beyond the node
    bool wanted = false;                                 ///< by more than a prefetch
    bool prefetched = false;                             ///< it was asked for by one
    std::int64_t asked = 0;                              ///< in this cycle
    memory::RecordKind kind = memory::RecordKind::node;  ///< of the record for which it was asked
    walk::Origin origin{};
    std::vector<std::uint32_t> waiters;  ///< what the user of this class has put there
  };

  explicit LineRegisters(std::uint32_t count)
      : keys_(count, free_key), registers_(count), free_((count + 63) / 64, ~std::uint64_t{0}) {
    if (count % 64 != 0) {
      free_.back() = (std::uint64_t{1} << (count % 64)) - 1;
    }
  }

  /// The register of a line that is under way.
  [[nodiscard]] std::optional<std::uint32_t> find(Key key) const {
    if (used_ != 0) {
      for (std::uint32_t i = 0; i < keys_.size(); ++i) {
        if (keys_[i] == key) {
          return i;
        }
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] bool full() const { return used_ == keys_.size(); }
  [[nodiscard]] std::uint32_t used() const { return used_; }
  /// Of these, whose lines are wanted by more than a prefetch.
  [[nodiscard]] std::uint32_t wanted() const { return wanted_; }
  /// Of these, whose lines left the node.
  [[nodiscard]] std::uint32_t left() const { return left_; }

  /// Takes the lowest free register, of which there must be one.
  std::uint32_t take(Key key, bool left, bool prefetched, std::int64_t cycle) {
    std::size_t word = 0;
    while (free_[word] == 0) {
      ++word;
    }
    const auto number =
        static_cast<std::uint32_t>(word * 64 + static_cast<unsigned>(std::countr_zero(free_[word])));
    free_[word] &= free_[word] - 1;
    ++used_;
    keys_[number] = key;
    registers_[number].left = left;
    registers_[number].wanted = false;
    registers_[number].prefetched = prefetched;
    registers_[number].asked = cycle;
    if (!prefetched) {
      want(number);
    }
    return number;
  }
  /// The register's line is wanted by more than a prefetch from now on.
  void want(std::uint32_t number) {
    Register& wanted = registers_[number];
    if (!std::exchange(wanted.wanted, true)) {
      ++wanted_;
      left_ += wanted.left ? 1 : 0;
    }
  }
  void give_back(std::uint32_t number) {
    free_[number / 64] |= std::uint64_t{1} << (number % 64);
    --used_;
    if (registers_[number].wanted) {
      --wanted_;
      left_ -= registers_[number].left ? 1 : 0;
    }
    keys_[number] = free_key;
    registers_[number].waiters.clear();
  }
  Register& operator[](std::uint32_t number) { return registers_[number]; }

 private:
  static constexpr Key free_key = ~Key{0};

  std::vector<Key> keys_;
  std::vector<Register> registers_;
  std::vector<std::uint64_t> free_;  // a bit for each register
  std::uint32_t used_ = 0;
  std::uint32_t wanted_ = 0;
  std::uint32_t left_ = 0;
};

}  // namespace marti::processors::simt
