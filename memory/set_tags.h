// Tags of set-associative caches with few ways, searched one by one.
//
// One object holds the tags of many equal caches (one per simulated node) in one array, so that 65,536
// small caches are one allocation and a look-up touches only its own set.
#pragma once

#include <algorithm>
#include <cstdint>

#include "memory/cache_config.h"
#include "memory/policies.h"
#include "sim/large_pages.h"

namespace marti::memory {

/// Line numbers have 32 bits; this one is never a line of a database.
inline constexpr std::uint32_t no_line = 0xffffffffU;

/// The set of a line: the line's number modulo the number of sets.
class SetIndex {
 public:
  explicit SetIndex(std::uint32_t sets) : sets_(sets), mask_(sets - 1), masked_((sets & (sets - 1)) == 0) {}
  std::uint32_t operator()(std::uint32_t line) const { return masked_ ? line & mask_ : line % sets_; }

 private:
  std::uint32_t sets_;
  std::uint32_t mask_;
  bool masked_;
};

/// `Policy` decides the victim; `Ways` is the number of ways if it is known at compile time, else 0. Within a
/// set, LRU and FIFO keep the newest line first (LRU also moves a line to the front when it hits), so the
/// victim is always the last; under other policies lines stay in their ways (victims.h).
template <Replacement Policy, std::uint32_t Ways>
class SetTags {
 public:
  SetTags(const CacheShape& shape, std::uint32_t caches, std::uint64_t seed)
      : index_(shape.sets),
        sets_(shape.sets),
        ways_(shape.ways),
        tags_(std::size_t{caches} * shape.lines()),
        victims_(std::size_t{caches} * shape.sets, shape.ways, seed) {}

  /// One of the caches, with everything that a look-up needs in registers. It must not outlive the store.
  class View {
   public:
    View(SetTags& store, std::uint32_t cache)
        : store_(&store),
          index_(store.index_),
          ways_(Ways == 0 ? store.ways_ : Ways),
          first_set_(std::size_t{cache} * store.sets_),
          tags_(store.tags_.data() + first_set_ * ways_) {}

    /// Looks `line` up; true when the cache holds it. Brings a missing line in.
    [[gnu::always_inline]] bool access(std::uint32_t line) const {
      const std::uint32_t set = index_(line);
      std::uint32_t* const tags = tags_of(set);
      const std::uint32_t ways = Ways == 0 ? ways_ : Ways;
      const std::uint32_t tag = ~line;
      if (tags[0] == tag) {
        use(set, 0);
        return true;
      }
      std::uint32_t at = 1;
      while (at < ways && tags[at] != tag) {
        ++at;
      }
      if constexpr (stays_in_way<Policy>) {
        if (at < ways) {
          use(set, at);
          return true;
        }
        replace(tags, ways, set, tag);
        return false;
      } else {
        const bool hit = at < ways;
        if (Policy == Replacement::fifo && hit) {
          return true;
        }
        for (std::uint32_t way = hit ? at : ways - 1; way > 0; --way) {
          tags[way] = tags[way - 1];
        }
        tags[0] = tag;
        return hit;
      }
    }
    /// As access(), but does not bring a missing line in.
    bool touch(std::uint32_t line) const {
      // access() brings nothing in here, because the line is found.
      return holds(line) && access(line);
    }
    /// Whether the cache holds `line`; changes nothing.
    [[nodiscard]] bool holds(std::uint32_t line) const {
      const std::uint32_t* const tags = tags_of(index_(line));
      return std::find(tags, tags + ways_, ~line) != tags + ways_;
    }
    /// Removes `line`; true when the cache held it. Its way is then empty, and empty ways are filled first.
    bool remove(std::uint32_t line) const {
      std::uint32_t* const tags = tags_of(index_(line));
      std::uint32_t* const end = tags + ways_;
      std::uint32_t* const at = std::find(tags, end, ~line);
      if (at == end) {
        return false;
      }
      if constexpr (stays_in_way<Policy>) {
        *at = empty;
      } else {
        // Empty ways count as the oldest, so they are kept last.
        std::copy(at + 1, end, at);
        *(end - 1) = empty;
      }
      return true;
    }

   private:
    [[nodiscard]] std::uint32_t* tags_of(std::uint32_t set) const {
      return tags_ + std::size_t{set} * (Ways == 0 ? ways_ : Ways);
    }
    void use(std::uint32_t set, std::uint32_t way) const {
      if constexpr (stays_in_way<Policy>) {
        store_->victims_.use(first_set_ + set, way);
      }
    }
    // Fills the first empty way; where all are full, replaces a victim.
    void replace(std::uint32_t* tags, std::uint32_t ways, std::uint32_t set, std::uint32_t tag) const {
      std::uint32_t way = 0;
      while (way < ways && tags[way] != empty) {
        ++way;
      }
      if (way == ways) {
        way = store_->victims_.victim(first_set_ + set);
      }
      tags[way] = tag;
      store_->victims_.fill(first_set_ + set, way);
    }

    SetTags* store_;
    SetIndex index_;
    std::uint32_t ways_;
    std::size_t first_set_;
    std::uint32_t* tags_;
  };
  [[nodiscard]] View view(std::uint32_t cache) { return {*this, cache}; }

 private:
  // Tags are the complements of the lines' numbers, so that empty ways are 0.
  static constexpr std::uint32_t empty = ~no_line;

  SetIndex index_;
  std::uint32_t sets_;
  std::uint32_t ways_;
  sim::ZeroedTable<std::uint32_t> tags_;
  [[no_unique_address]] VictimsOf<Policy> victims_;
};

}  // namespace marti::memory
