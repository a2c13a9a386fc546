// Tags of caches with many ways (up to fully associative). Each set has a hash table from line to way, and
// for LRU and FIFO a list of its ways from the newest to the oldest; other policies have a state of their
// own. The time of a look-up does not depend on the number of ways.
#pragma once

#include <cstdint>
#include <vector>

#include "memory/cache_config.h"
#include "memory/set_tags.h"

namespace marti::memory {

template <Replacement Policy>
class HashedTags {
 public:
  HashedTags(const CacheShape& shape, std::uint32_t caches, std::uint64_t seed)
      : index_(shape.sets),
        sets_(shape.sets),
        ways_(shape.ways),
        slots_(slots_for(shape.ways)),
        ways_of_sets_(std::size_t{caches} * shape.lines()),
        table_(std::size_t{caches} * shape.sets * slots_, empty),
        state_(std::size_t{caches} * shape.sets),
        victims_(state_.size(), shape.ways, seed) {}

  /// One of the caches, with the members of SetTags::View.
  class View {
   public:
    View(HashedTags& tags, std::uint32_t cache) : tags_(&tags), cache_(cache) {}
    bool access(std::uint32_t line) const { return tags_->access(cache_, line); }
    bool touch(std::uint32_t line) const { return tags_->touch(cache_, line); }
    [[nodiscard]] bool holds(std::uint32_t line) const { return tags_->holds(cache_, line); }
    bool remove(std::uint32_t line) const { return tags_->remove(cache_, line); }

   private:
    HashedTags* tags_;
    std::uint32_t cache_;
  };
  [[nodiscard]] View view(std::uint32_t cache) { return {*this, cache}; }

 private:
  // Whether a list of the ways gives the oldest one.
  static constexpr bool listed = !stays_in_way<Policy>;

  bool access(std::uint32_t cache, std::uint32_t line) {
    const std::size_t set = std::size_t{cache} * sets_ + index_(line);
    Set& state = state_[set];
    Way* ways = ways_of_sets_.data() + set * ways_;
    std::uint32_t* table = table_.data() + set * slots_;
    if (const std::uint32_t held = find(table, ways, line); held != empty) {
      if constexpr (Policy == Replacement::lru) {
        move_to_front(state, ways, held);
      }
      if constexpr (!listed) {
        victims_.use(set, held);
      }
      return true;
    }
    const std::uint32_t way = free_way(state, ways, table, set);
    ways[way].line = line;
    insert(table, ways, way);
    if constexpr (listed) {
      push_front(state, ways, way);
    } else {
      victims_.fill(set, way);
    }
    return false;
  }

  [[nodiscard]] bool holds(std::uint32_t cache, std::uint32_t line) const {
    const std::size_t set = std::size_t{cache} * sets_ + index_(line);
    return find(table_.data() + set * slots_, ways_of_sets_.data() + set * ways_, line) != empty;
  }

  bool touch(std::uint32_t cache, std::uint32_t line) {
    const std::size_t set = std::size_t{cache} * sets_ + index_(line);
    return find(table_.data() + set * slots_, ways_of_sets_.data() + set * ways_, line) != empty &&
           access(cache, line);
  }

  bool remove(std::uint32_t cache, std::uint32_t line) {
    const std::size_t set = std::size_t{cache} * sets_ + index_(line);
    Way* ways = ways_of_sets_.data() + set * ways_;
    std::uint32_t* table = table_.data() + set * slots_;
    const std::uint32_t way = find(table, ways, line);
    if (way == empty) {
      return false;
    }
    Set& state = state_[set];
    erase(table, ways, line);
    if constexpr (listed) {
      unlink(state, ways, way);
    }
    ways[way].line = no_line;
    // Emptied ways are linked in ascending order.
    std::uint32_t* link = &state.emptied;
    while (*link < way) {
      link = &ways[*link].older;
    }
    ways[way].older = *link;
    *link = way;
    return true;
  }

  static constexpr std::uint32_t empty = 0xffffffffU;
  struct Way {
    std::uint32_t line = no_line;
    std::uint32_t newer = empty;
    std::uint32_t older = empty;
  };
  struct Set {
    std::uint32_t used = 0;         // number of ways ever used
    std::uint32_t emptied = empty;  // the first way that was used and is empty again
    std::uint32_t newest = empty;
    std::uint32_t oldest = empty;
  };

  // A power of two at least twice the number of ways, so that probe sequences are short.
  static std::uint32_t slots_for(std::uint32_t ways) {
    std::uint32_t slots = 4;
    while (slots < 2 * std::uint64_t{ways}) {
      slots *= 2;
    }
    return slots;
  }
  [[nodiscard]] std::uint32_t home(std::uint32_t line) const {
    return ((line * 0x9e3779b1U) ^ (line >> 15U)) & (slots_ - 1);
  }
  [[nodiscard]] std::uint32_t next(std::uint32_t slot) const { return (slot + 1) & (slots_ - 1); }

  // The way that holds `line`, or `empty`.
  [[nodiscard]] std::uint32_t find(const std::uint32_t* table, const Way* ways, std::uint32_t line) const {
    std::uint32_t slot = home(line);
    while (table[slot] != empty && ways[table[slot]].line != line) {
      slot = next(slot);
    }
    return table[slot];
  }

  void insert(std::uint32_t* table, const Way* ways, std::uint32_t way) const {
    std::uint32_t slot = home(ways[way].line);
    while (table[slot] != empty) {
      slot = next(slot);
    }
    table[slot] = way;
  }

  // Linear probing with backward shift: an entry behind the hole moves up unless that is before its home.
  void erase(std::uint32_t* table, const Way* ways, std::uint32_t line) const {
    std::uint32_t hole = home(line);
    while (ways[table[hole]].line != line) {
      hole = next(hole);
    }
    for (std::uint32_t slot = next(hole); table[slot] != empty; slot = next(slot)) {
      const std::uint32_t wanted = home(ways[table[slot]].line);
      if (((slot - wanted) & (slots_ - 1)) >= ((slot - hole) & (slots_ - 1))) {
        table[hole] = table[slot];
        hole = slot;
      }
    }
    table[hole] = empty;
  }

  std::uint32_t free_way(Set& state, Way* ways, std::uint32_t* table, std::size_t set) {
    if (state.emptied != empty) {
      const std::uint32_t way = state.emptied;
      state.emptied = ways[way].older;
      return way;
    }
    if (state.used < ways_) {
      return state.used++;
    }
    std::uint32_t victim = state.oldest;
    if constexpr (listed) {
      unlink(state, ways, victim);
    } else {
      victim = victims_.victim(set);
    }
    erase(table, ways, ways[victim].line);
    return victim;
  }

  static void unlink(Set& state, Way* ways, std::uint32_t way) {
    const Way& gone = ways[way];
    (gone.newer == empty ? state.newest : ways[gone.newer].older) = gone.older;
    (gone.older == empty ? state.oldest : ways[gone.older].newer) = gone.newer;
  }
  static void push_front(Set& state, Way* ways, std::uint32_t way) {
    ways[way].newer = empty;
    ways[way].older = state.newest;
    (state.newest == empty ? state.oldest : ways[state.newest].newer) = way;
    state.newest = way;
  }
  static void move_to_front(Set& state, Way* ways, std::uint32_t way) {
    if (state.newest != way) {
      unlink(state, ways, way);
      push_front(state, ways, way);
    }
  }

  SetIndex index_;
  std::uint32_t sets_;
  std::uint32_t ways_;
  std::uint32_t slots_;
  std::vector<Way> ways_of_sets_;
  std::vector<std::uint32_t> table_;
  std::vector<Set> state_;
  [[no_unique_address]] VictimsOf<Policy> victims_;
};

}  // namespace marti::memory
