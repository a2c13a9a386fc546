// The recency order of four ways as one small number, with the transition table that a look-up needs.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace marti::memory {

/// All 24 orders of four ways. A state is the number of its order times 16, so that state + match indexes the
/// table; `match` is the result of the look-up, one bit for each way. In state 0 way 0 is the most recent and
/// way 3 the victim.
struct LruStates {
  static constexpr std::uint32_t ways = 4;
  static constexpr std::size_t orders = 24;
  static constexpr std::size_t matches = 16;

  /// [state + match]: the state after a hit of the lowest way in `match`; for match 0, after the victim was
  /// replaced.
  std::array<std::uint16_t, orders * matches> next{};
  /// [state / 16]: the least recent way.
  std::array<std::uint8_t, orders> victim{};
  /// [state / 16 * ways + way]: the state after `way` was emptied, which makes it the next victim.
  std::array<std::uint16_t, orders * ways> emptied{};

  constexpr LruStates() {
    using Order = std::array<std::uint8_t, ways>;  // most recent first
    std::array<Order, orders> known{Order{0, 1, 2, 3}};
    std::size_t count = 1;
    // Orders are found from the first on by moving each way to the front, until no new one appears.
    const auto after = [&](const Order& order, std::uint8_t way) {
      Order moved{way};
      std::size_t at = 1;
      for (const std::uint8_t other : order) {
        if (other != way) {
          moved[at++] = other;
        }
      }
      std::size_t found = 0;
      while (found < count && known[found] != moved) {
        ++found;
      }
      if (found == count) {
        known[count++] = moved;
      }
      return static_cast<std::uint16_t>(found * matches);
    };
    for (std::size_t order = 0; order < count; ++order) {
      const Order current = known[order];
      victim[order] = current[ways - 1];
      for (std::uint32_t match = 0; match < matches; ++match) {
        const auto way = match == 0 ? victim[order] : static_cast<std::uint8_t>(std::countr_zero(match));
        next[order * matches + match] = after(current, way);
      }
      for (std::uint8_t way = 0; way < ways; ++way) {
        // Moving the three others to the front, the least recent first, leaves `way` last.
        auto state = static_cast<std::uint16_t>(order * matches);
        for (std::size_t at = ways; at-- > 0;) {
          if (current[at] != way) {
            state = after(known[state / matches], current[at]);
          }
        }
        emptied[order * ways + way] = state;
      }
    }
  }
};

inline constexpr LruStates lru_states;

}  // namespace marti::memory
