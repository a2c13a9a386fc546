// Tags of set-associative caches with few ways, searched one by one.
//
// One object holds the tags of many equal caches (one per simulated node) in one array, so that 65,536
// small caches are one allocation and a look-up touches only its own set.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "memory/cache_config.h"
#include "memory/plru_trees.h"
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
/// victim is always the last; random replacement and tree-PLRU leave lines in their ways.
template <Replacement Policy, std::uint32_t Ways>
class SetTags {
 public:
  SetTags(const CacheShape& shape, std::uint32_t caches, std::uint64_t seed)
      : index_(shape.sets), sets_(shape.sets), ways_(shape.ways), tags_(std::size_t{caches} * shape.lines()) {
    if constexpr (Policy == Replacement::random) {
      const std::uint64_t all_sets = std::uint64_t{caches} * shape.sets;
      victims_.reserve(all_sets);
      for (std::uint64_t set = 0; set < all_sets; ++set) {
        victims_.emplace_back(seed, set);
      }
    }
    if constexpr (Policy == Replacement::plru) {
      trees_ = PlruTrees(std::size_t{caches} * shape.sets, shape.ways);
    }
  }

  /// One of the caches. It must not outlive the store.
  class View {
   public:
    View(SetTags& tags, std::uint32_t cache) : tags_(&tags), cache_(cache) {}
    /// Looks `line` up; true when the cache holds it. Brings a missing line in.
    bool access(std::uint32_t line) const { return tags_->access(cache_, line); }
    /// As access(), but does not bring a missing line in.
    bool touch(std::uint32_t line) const { return tags_->touch(cache_, line); }
    /// Whether the cache holds `line`; changes nothing.
    [[nodiscard]] bool holds(std::uint32_t line) const { return tags_->holds(cache_, line); }
    /// Removes `line`; true when the cache held it. Its way is then empty, and empty ways are filled first.
    bool remove(std::uint32_t line) const { return tags_->remove(cache_, line); }

   private:
    SetTags* tags_;
    std::uint32_t cache_;
  };
  [[nodiscard]] View view(std::uint32_t cache) { return {*this, cache}; }

 private:
  // Tags are the complements of the lines' numbers, so that empty ways are 0.
  static constexpr std::uint32_t empty = ~no_line;
  // Whether lines stay in the way that they were brought into.
  static constexpr bool stays = Policy == Replacement::random || Policy == Replacement::plru;

  bool access(std::uint32_t cache, std::uint32_t line) {
    const std::size_t set = std::size_t{cache} * sets_ + index_(line);
    const std::uint32_t ways = Ways == 0 ? ways_ : Ways;
    std::uint32_t* tags = tags_.data() + set * ways;
    const std::uint32_t tag = ~line;
    if (tags[0] == tag) {
      use(set, 0);
      return true;
    }
    std::uint32_t at = 1;
    while (at < ways && tags[at] != tag) {
      ++at;
    }
    if constexpr (stays) {
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

  std::uint32_t* set_of(std::uint32_t cache, std::uint32_t line) {
    return tags_.data() + (std::size_t{cache} * sets_ + index_(line)) * (Ways == 0 ? ways_ : Ways);
  }

  bool holds(std::uint32_t cache, std::uint32_t line) {
    const std::uint32_t* const tags = set_of(cache, line);
    const std::uint32_t* const end = tags + (Ways == 0 ? ways_ : Ways);
    return std::find(tags, end, ~line) != end;
  }

  bool touch(std::uint32_t cache, std::uint32_t line) {
    const std::uint32_t* const tags = set_of(cache, line);
    const std::uint32_t ways = Ways == 0 ? ways_ : Ways;
    // access() brings nothing in here, because the line is found.
    return std::find(tags, tags + ways, ~line) != tags + ways && access(cache, line);
  }

  bool remove(std::uint32_t cache, std::uint32_t line) {
    std::uint32_t* const tags = set_of(cache, line);
    std::uint32_t* const end = tags + (Ways == 0 ? ways_ : Ways);
    std::uint32_t* const at = std::find(tags, end, ~line);
    if (at == end) {
      return false;
    }
    if constexpr (stays) {
      *at = empty;
    } else {
      // Empty ways count as the oldest, so they are kept last.
      std::copy(at + 1, end, at);
      *(end - 1) = empty;
    }
    return true;
  }

  void use(std::size_t set, std::uint32_t way) {
    if constexpr (Policy == Replacement::plru) {
      trees_.use(set, way);
    }
  }

  [[nodiscard]] std::uint32_t victim(std::size_t set, std::uint32_t ways) {
    if constexpr (Policy == Replacement::plru) {
      return trees_.victim(set);
    } else {
      return victims_[set].next(ways);
    }
  }

  // Fills the first empty way; only if there is none, a victim is replaced.
  void replace(std::uint32_t* tags, std::uint32_t ways, std::size_t set, std::uint32_t tag) {
    std::uint32_t way = 0;
    while (way < ways && tags[way] != empty) {
      ++way;
    }
    if (way == ways) {
      way = victim(set, ways);
    }
    tags[way] = tag;
    use(set, way);
  }

  SetIndex index_;
  std::uint32_t sets_;
  std::uint32_t ways_;
  sim::ZeroedTable<std::uint32_t> tags_;
  std::vector<VictimStream> victims_;
  PlruTrees trees_;
};

}  // namespace marti::memory
