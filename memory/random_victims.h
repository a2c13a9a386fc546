// Random replacement: a stream of victims for each set, which depends only on the seed and the set.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/mix.h"

namespace marti::memory {

/// Each call gives the next way, uniform over 0 .. ways - 1 up to 2^-32 (SplitMix64, Steele et al. 2014,
/// scaled by the high half of a product).
class VictimStream {
 public:
  VictimStream(std::uint64_t seed, std::uint64_t set) : state_(seed + set * 0xd1342543de82ef95ULL) {}
  std::uint32_t next(std::uint32_t ways) {
    state_ += sim::mix_step;
    return static_cast<std::uint32_t>(((sim::mixed_bits(state_) >> 32U) * ways) >> 32U);
  }

 private:
  std::uint64_t state_;
};

class RandomVictims {
 public:
  RandomVictims(std::size_t sets, std::uint32_t ways, std::uint64_t seed) : ways_(ways) {
    streams_.reserve(sets);
    for (std::uint64_t set = 0; set < sets; ++set) {
      streams_.emplace_back(seed, set);
    }
  }
  void fill(std::size_t /*set*/, std::uint32_t /*way*/) {}
  void use(std::size_t /*set*/, std::uint32_t /*way*/) {}
  std::uint32_t victim(std::size_t set) { return streams_[set].next(ways_); }
  static void check(std::uint64_t /*ways*/) {}
  static std::uint64_t bytes_a_set(std::uint64_t /*ways*/) { return sizeof(VictimStream); }
  static constexpr bool counts_repeats = false;

 private:
  std::uint32_t ways_;
  std::vector<VictimStream> streams_;
};

}  // namespace marti::memory
