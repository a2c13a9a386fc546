// Why a cache missed.
//
// The classes are those of Hill and Smith, Evaluating associativity in CPU caches, IEEE Transactions on
// Computers 38(12), 1989, reference by reference, and beside them the misses that coherence makes:
//   compulsory    the cache has never had the line
//   invalidation  a write of somebody else has taken the line out since
//   capacity      a fully associative LRU cache of as many lines would miss too
//   conflict      the rest: it would have had the line
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "memory/line_bits.h"
#include "memory/tag_array.h"

namespace marti::memory {

enum class MissClass : std::uint8_t { compulsory, capacity, conflict, invalidation };
inline constexpr std::size_t miss_classes = 4;
inline constexpr std::array<std::string_view, miss_classes> miss_class_names = {"compulsory", "capacity",
                                                                                "conflict", "invalidation"};

/// Follows many equal caches, each on its own.
class MissClassifier {
 public:
  /// `lines` of each cache, at least 1.
  MissClassifier(std::uint64_t lines, std::uint32_t caches);

  /// Every reference of a cache, in order.
  void hit(std::uint32_t cache, std::uint32_t line) { (void)full_.access(cache, line); }
  MissClass miss(std::uint32_t cache, std::uint32_t line);
  /// A write has taken out a line that the cache had.
  void taken_out(std::uint32_t cache, std::uint32_t line);

 private:
  TagArray full_;
  std::vector<LineBits> had_;
  std::vector<LineBits> taken_;  // and not brought in again
};

}  // namespace marti::memory
