// Classes of cache misses, by cause.
//
// The classes are those of Hill and Smith, Evaluating associativity in CPU caches, IEEE Transactions on
// Computers 38(12), 1989, reference by reference, and in addition the misses caused by coherence:
//   compulsory    the cache has never held the line
//   invalidation  a write by another node has removed the line since
//   capacity      a fully associative LRU cache of as many lines would miss too
//   conflict      the rest: that cache would have held the line
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

/// Classifies the misses of many equal caches, each independently of the others.
class MissClassifier {
 public:
  /// `lines`, at least 1, is the number of lines of each cache.
  MissClassifier(std::uint64_t lines, std::uint32_t caches);

  /// Call hit() or miss() for every reference of a cache, in order.
  void hit(std::uint32_t cache, std::uint32_t line) { (void)full_.access(cache, line); }
  MissClass miss(std::uint32_t cache, std::uint32_t line);
  /// Another node has written the line, which removes it. `held`: the cache had it, so that its next miss of
  /// the line is due to the write.
  void written(std::uint32_t cache, std::uint32_t line, bool held);

 private:
  TagArray full_;
  std::vector<LineBits> had_;
  std::vector<LineBits> taken_;  // lines removed by a write and not brought in again
};

}  // namespace marti::memory
