// The tags of many equal caches of any kind, behind one call: for look-ups that are too rare to be worth
// code of their own for each kind of cache.
#pragma once

#include <cstdint>
#include <memory>

#include "memory/cache_config.h"

namespace marti::memory {

/// Caches and lines are numbered from 0; a line is an address divided by the length of a line, below 2^32
/// - 1.
class TagArray {
 public:
  /// Throws UserError when the configuration describes no cache.
  TagArray(const CacheConfig& config, std::uint32_t caches);
  ~TagArray();
  TagArray(TagArray&&) noexcept;
  TagArray& operator=(TagArray&&) noexcept;
  TagArray(const TagArray&) = delete;
  TagArray& operator=(const TagArray&) = delete;

  /// Looks `line` up; true when it is there. Brings it in when it is not.
  bool access(std::uint32_t cache, std::uint32_t line);
  /// The same, but a line that is not there is not brought in.
  bool touch(std::uint32_t cache, std::uint32_t line);
  /// Takes `line` out; true when it was there.
  bool remove(std::uint32_t cache, std::uint32_t line);
  /// Whether `line` is there; changes nothing.
  [[nodiscard]] bool holds(std::uint32_t cache, std::uint32_t line);

  /// The look-up behind the interface; defined in tag_array.cpp.
  struct Store;

 private:
  std::unique_ptr<Store> store_;
};

}  // namespace marti::memory
