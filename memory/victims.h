// Which line of a full set makes room, under policies in which lines stay in the ways that they came into.
//
// A policy is a class in a file of its own, with the members below, and a specialisation of VictimsOf beside
// it; policies.h includes that file, and cache_config.h has its name.
//   Class(std::size_t sets, std::uint32_t ways, std::uint64_t seed);  of all sets of many equal caches
//   void fill(std::size_t set, std::uint32_t way);    a line that was missing has come into the way
//   void use(std::size_t set, std::uint32_t way);     the way's line was looked up and found
//   std::uint32_t victim(std::size_t set);            of a set without empty ways; that way is filled next
//   static void check(std::uint64_t ways);            throws UserError for sets that the policy is not for
//   static std::uint64_t bytes_a_set(std::uint64_t ways);  of the host's memory
//   static constexpr bool counts_repeats              whether it matters that a line is looked up twice in a
//   row
// To remove a line from a cache changes nothing of this. Empty ways are filled before a victim is asked for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace marti::memory {

/// LRU and FIFO: lines are kept in the order of their last use or of their coming, which says it all.
struct KeptInOrder {
  KeptInOrder(std::size_t /*sets*/, std::uint32_t /*ways*/, std::uint64_t /*seed*/) {}
  static void check(std::uint64_t /*ways*/) {}
  static std::uint64_t bytes_a_set(std::uint64_t /*ways*/) { return 0; }
  static constexpr bool counts_repeats = false;
};

}  // namespace marti::memory
