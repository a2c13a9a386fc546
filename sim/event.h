// An event of the simulation.
#pragma once

#include <cstdint>
#include <limits>

#include "sim/time.h"

namespace marti::sim {

inline constexpr unsigned sequence_bits = 24;
inline constexpr unsigned component_bits = 32;

/// One event. Events are ordered by (time, class, component, sequence), packed so that two integer
/// comparisons decide; the order at equal times never depends on the order of insertion. A component that may
/// have several events of one class pending gives each a sequence number of its own. Events are passed by
/// value: in registers, and not in memory, where compilers load both halves at once just after each was
/// stored.
struct Event {
  Ticks time = 0;
  std::uint64_t order = 0;

  [[nodiscard]] static Event make(Ticks time, std::uint8_t event_class, std::uint32_t component,
                                  std::uint32_t sequence = 0) {
    return {time, (std::uint64_t{event_class} << (component_bits + sequence_bits)) |
                      (std::uint64_t{component} << sequence_bits) |
                      (sequence & ((1U << sequence_bits) - 1U))};
  }
  /// Later than every event of a simulation, whose classes end far below 255.
  [[nodiscard]] static constexpr Event never() {
    return {std::numeric_limits<Ticks>::max(), std::numeric_limits<std::uint64_t>::max()};
  }
  [[nodiscard]] std::uint8_t event_class() const {
    return static_cast<std::uint8_t>(order >> (component_bits + sequence_bits));
  }
  [[nodiscard]] std::uint32_t component() const { return static_cast<std::uint32_t>(order >> sequence_bits); }
  [[nodiscard]] std::uint32_t sequence() const {
    return static_cast<std::uint32_t>(order) & ((1U << sequence_bits) - 1U);
  }

  // One comparison of 128 bits, without a branch: which of two events is earlier is not predictable.
  friend bool operator<(const Event& a, const Event& b) { return a.key() < b.key(); }

 private:
  __extension__ using Key = __int128;
  [[nodiscard]] Key key() const { return static_cast<Key>(time) << 64U | order; }
};

}  // namespace marti::sim
