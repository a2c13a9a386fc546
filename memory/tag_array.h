// The tags of many equal caches of any kind, behind one interface: for look-ups that are too rare to justify
// separate code for each kind of cache.
#pragma once

#include <cstdint>
#include <memory>

#include "memory/cache_config.h"

namespace marti::memory {

/// Caches and lines are numbered from 0; a line is an address divided by the length of a line, below 2^32
/// - 1.
class TagArray {
 public:
  /// Throws UserError when no cache can have this configuration.
  TagArray(const CacheConfig& config, std::uint32_t caches);
  ~TagArray();
  TagArray(TagArray&&) noexcept;
  TagArray& operator=(TagArray&&) noexcept;
  TagArray(const TagArray&) = delete;
  TagArray& operator=(const TagArray&) = delete;

  /// Looks `line` up; true when the cache holds it. Brings a missing line in.
  bool access(std::uint32_t cache, std::uint32_t line);
  /// As access(), but does not bring a missing line in.
  bool touch(std::uint32_t cache, std::uint32_t line);
  /// Removes `line`; true when the cache held it.
  bool remove(std::uint32_t cache, std::uint32_t line);
  /// Whether the cache holds `line`; changes nothing.
  [[nodiscard]] bool holds(std::uint32_t cache, std::uint32_t line);

  /// The implementation of the look-ups; defined in tag_array.cpp.
  struct Store;

 private:
  std::unique_ptr<Store> store_;
};

}  // namespace marti::memory
