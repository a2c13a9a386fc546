// The recency order of a few ways as one small number, with the transition table that a hit needs.
#pragma once

#include <array>
#include <cstdint>

namespace marti::memory {

/// All orders of `Ways` ways (at most 4, so at most 24 states). State 0 has way 0 as the most recent and
/// the last way as the victim.
template <std::uint32_t Ways>
struct LruStates {
  static_assert(Ways >= 1 && Ways <= 4);
  static constexpr std::size_t count = Ways == 4 ? 24 : (Ways == 3 ? 6 : Ways);

  std::array<std::array<std::uint8_t, 4>, count> after_use{};  ///< [state][way]: state after a use of the way
  std::array<std::uint8_t, count> victim{};                    ///< [state]: the least recent way

  constexpr LruStates() {
    // Orders are found from state 0 by moving each way to the front, until no new order appears.
    std::array<std::array<std::uint8_t, Ways>, count> orders{};
    std::size_t known = 1;
    for (std::uint8_t way = 0; way < Ways; ++way) {
      orders[0][way] = way;
    }
    for (std::size_t state = 0; state < known; ++state) {
      victim[state] = orders[state][Ways - 1];
      for (std::uint8_t way = 0; way < Ways; ++way) {
        std::array<std::uint8_t, Ways> next{way};
        std::size_t at = 1;
        for (const std::uint8_t other : orders[state]) {
          if (other != way) {
            next[at++] = other;
          }
        }
        std::size_t found = 0;
        while (found < known && orders[found] != next) {
          ++found;
        }
        if (found == known) {
          orders[known++] = next;
        }
        after_use[state][way] = static_cast<std::uint8_t>(found);
      }
    }
  }
};

template <std::uint32_t Ways>
inline constexpr LruStates<Ways> lru_states{};

}  // namespace marti::memory
