// What is due at a node in cycles to come.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace marti::processors::simt {

/// A cycle later than all others.
inline constexpr std::int64_t no_cycle = std::numeric_limits<std::int64_t>::max();

/// What becomes due, and of what: a warp for packet and slot, an entry of a pool for the others.
enum class Due : std::uint8_t { packet, slot, hit, line, test, wake };
struct DueEntry {
  Due due = Due::wake;
  std::uint32_t of = 0;
};

/// Most things are due within the next cycles: these are in a ring of one list for each cycle. Cycles passed
/// to take() must increase, and what is pushed must be later than the last one taken.
class CycleQueue {
 public:
  void push(std::int64_t cycle, DueEntry entry) {
    if (cycle - taken_ < ring_size) {
      ring_[static_cast<std::size_t>(cycle) % ring_size].push_back(entry);
      filled_ |= bit(cycle);
    } else {
      far_.push_back({cycle, entry});
      std::push_heap(far_.begin(), far_.end(), Later{});
    }
  }

  /// The first cycle in which something is due; no_cycle if nothing is.
  [[nodiscard]] std::int64_t next() const {
    std::int64_t first = far_.empty() ? no_cycle : far_.front().cycle;
    if (filled_ != 0) {
      const auto from = static_cast<int>((taken_ + 1) % ring_size);
      first = std::min(first, taken_ + 1 + std::countr_zero(std::rotr(filled_, from)));
    }
    return first;
  }

  /// Calls use(entry) for all that is due in `cycle`, which is not after next().
  template <class Use>
  void take(std::int64_t cycle, const Use& use) {
    taken_ = cycle;
    if ((filled_ & bit(cycle)) != 0) {
      filled_ &= ~bit(cycle);
      std::vector<DueEntry>& due = ring_[static_cast<std::size_t>(cycle) % ring_size];
      for (const DueEntry& entry : due) {
        use(entry);
      }
      due.clear();
    }
    while (!far_.empty() && far_.front().cycle == cycle) {
      std::pop_heap(far_.begin(), far_.end(), Later{});
      const DueEntry entry = far_.back().entry;
      far_.pop_back();
      use(entry);
    }
  }

  /// Calls visit(cycle, entry) for all entries, in no order.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::int64_t cycle = taken_ + 1; cycle < taken_ + ring_size; ++cycle) {
      for (const DueEntry& entry : ring_[static_cast<std::size_t>(cycle) % ring_size]) {
        visit(cycle, entry);
      }
    }
    for (const Far& far : far_) {
      visit(far.cycle, far.entry);
    }
  }

 private:
  static constexpr std::int64_t ring_size = 64;
  struct Far {
    std::int64_t cycle = 0;
    DueEntry entry;
  };
  struct Later {
    bool operator()(const Far& a, const Far& b) const { return a.cycle > b.cycle; }
  };
  static std::uint64_t bit(std::int64_t cycle) { return std::uint64_t{1} << (cycle % ring_size); }

  std::int64_t taken_ = -1;
  std::uint64_t filled_ = 0;  // cycles of the ring, modulo its size, in which something is due
  std::array<std::vector<DueEntry>, ring_size> ring_;
  std::vector<Far> far_;  // a heap
};

}  // namespace marti::processors::simt
