// Static re-reference interval prediction (SRRIP): a line that comes in is expected to be used again in a
// long while, one that has been used again soon, so that a stream of lines that are used once does not drive
// out those that are used often. (Jaleel, A., Theobald, K., Steely, S., Emer, J., High performance cache
// replacement using re-reference interval prediction, ISCA 2010, section 4: counters of 2 bits, hit
// priority.)
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/error.h"

namespace marti::memory {

class RripCounters {
 public:
  RripCounters(std::size_t sets, std::uint32_t ways, std::uint64_t /*seed*/)
      : ways_(ways), counters_(sets * ways, distant) {}

  void fill(std::size_t set, std::uint32_t way) { counters_[set * ways_ + way] = distant - 1; }
  void use(std::size_t set, std::uint32_t way) { counters_[set * ways_ + way] = 0; }

  /// The first way that is expected to be used last. All counters of the set grow until that way's is the
  /// largest that there is.
  std::uint32_t victim(std::size_t set) {
    std::uint8_t* const first = counters_.data() + set * ways_;
    const std::uint8_t* const last_used = std::max_element(first, first + ways_);
    if (const auto missing = static_cast<std::uint8_t>(distant - *last_used); missing > 0) {
      std::for_each(first, first + ways_, [missing](std::uint8_t& counter) {
        counter = static_cast<std::uint8_t>(counter + missing);
      });
    }
    return static_cast<std::uint32_t>(last_used - first);
  }

  static void check(std::uint64_t ways) {
    if (ways > most_ways) {
      throw sim::UserError("SRRIP replacement is for sets of at most " + std::to_string(most_ways) +
                           " ways, not of " + std::to_string(ways));
    }
  }
  static std::uint64_t bytes_a_set(std::uint64_t ways) { return ways; }
  static constexpr bool counts_repeats =
      true;  // the first use after a line has come makes it one of those used again

 private:
  static constexpr std::uint8_t distant = 3;
  static constexpr std::uint64_t most_ways = 65'536;  // a victim is searched among all of them

  std::uint32_t ways_;
  std::vector<std::uint8_t> counters_;  // 0: used again soon, up to 3: in the distant future
};

}  // namespace marti::memory
