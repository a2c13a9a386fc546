// The look-ups of nodes that build the tree while they use it, which say what a reference is for where that
// is counted. Where it is not, they are those of the caches.
#pragma once

#include <utility>

#include "processors/node/dynamic_cursor.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/node_caches.h"

namespace marti::processors::node {

/// Holds the caches: a class of node_caches.h, or CountedCaches; either may be guarded.
template <class Caches>
class CountedLookUps {
 public:
  static constexpr bool counted = walk::are_counted<Caches>;
  using View = typename Caches::View;

  explicit CountedLookUps(Caches caches) : caches_(std::move(caches)) {}

  [[nodiscard]] Caches& caches() { return caches_; }
  [[nodiscard]] const Caches& caches() const { return caches_; }

  /// Looks a line up, of which so many bytes are wanted, and brings a missing one in. `own`: see
  /// CacheCounting::refer.
  static bool access(View cache, const DynamicCursor& cursor, std::uint32_t line, std::uint32_t bytes,
                     bool own) {
    if constexpr (counted) {
      return cache.access(cursor.kind, line,
                          walk::Use{origin_of(cursor), cursor.time, cursor.at, bytes, own});
    } else {
      return cache.access(cursor.kind, line);
    }
  }
  /// Looks a line up; a missing one is not brought in.
  static bool touch(View cache, const DynamicCursor& cursor, std::uint32_t line, std::uint32_t bytes) {
    if constexpr (counted) {
      return cache.touch(cursor.kind, line, walk::Use{origin_of(cursor), cursor.time, cursor.at, bytes});
    } else {
      return cache.touch(cursor.kind, line);
    }
  }

  /// What the references from now on are for: a ray; a level of the tree, or 0.
  static void note_ray(DynamicCursor& cursor, std::uint32_t operand) {
    if constexpr (counted) {
      cursor.origin.begin_ray(operand);
    }
  }
  static void note_level(DynamicCursor& cursor, std::uint8_t level) {
    if constexpr (counted) {
      cursor.origin.level = level;
    }
  }

  void note_second_level_hit(const DynamicCursor& cursor) const {
    if constexpr (counted) {
      caches_.counting().second_level_hit(cursor.kind, origin_of(cursor));
    }
  }
  void note_wait(const DynamicCursor& cursor, const memory::Service& service) const {
    if constexpr (counted) {
      caches_.counting().wait(cursor.kind, origin_of(cursor), service);
    }
  }
  /// The counts beyond hits and misses; empty where nothing is counted.
  [[nodiscard]] walk::CacheCountResult counts() const {
    if constexpr (counted) {
      return caches_.counting().result();
    } else {
      return {};
    }
  }

 private:
  static walk::Origin origin_of(const DynamicCursor& cursor) {
    walk::Origin origin = cursor.origin;
    origin.splitting = cursor.before || is_for_split(cursor.todo);
    return origin;
  }

  Caches caches_;
};

}  // namespace marti::processors::node
