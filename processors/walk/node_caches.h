// The private caches of all nodes, as the node's inner loop uses them: one call that returns hit or miss.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "memory/line_set.h"
#include "memory/record_kind.h"
#include "memory/tag_array.h"
#include "processors/machine/machine_config.h"

namespace marti::processors::walk {

/// Which of the split caches a record kind uses.
inline constexpr std::array<std::uint8_t, memory::record_kinds> split_cache_of = {0, 0, 1, 2, 3, 3, 3};

/// Whether the caches count more than hits and misses: CountedCaches, and these guarded.
template <class Caches>
inline constexpr bool are_counted = requires {
  Caches::counted;
};

/// Unified caches, with a tag store whose class is known at compile time.
template <class Tags>
class UnifiedCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = false;  ///< the record kind does not matter
  UnifiedCaches(const machine::MachineConfig& config, const memory::CacheShape& shape)
      : tags_(shape, config.all_nodes(), config.cache.cache.seed) {}
  class View {
   public:
    explicit View(typename Tags::View tags) : tags_(tags) {}
    [[gnu::always_inline]] bool access(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return tags_.access(line);
    }
    /// As access(), but a line that is missing is not brought in.
    [[gnu::always_inline]] bool touch(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return tags_.touch(line);
    }
    /// Whether a line is there; changes nothing.
    [[nodiscard]] bool holds(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return tags_.holds(line);
    }
    /// Removes a line, whatever kinds of record it holds; returns how many copies there were.
    [[nodiscard]] std::int64_t remove(std::uint32_t line) const { return tags_.remove(line) ? 1 : 0; }
    static std::size_t cache_of(memory::RecordKind /*kind*/) { return 0; }

   private:
    typename Tags::View tags_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return View(tags_.view(node)); }

 private:
  Tags tags_;
};

/// Caches of any kind, unified or split: a virtual call for each look-up.
class AnyCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = true;
  explicit AnyCaches(const machine::MachineConfig& config) : tags_(tags_of(config)) {}
  class View {
   public:
    View(std::vector<memory::TagArray>& tags, std::uint32_t node) : tags_(tags), node_(node) {}
    bool access(memory::RecordKind kind, std::uint32_t line) const {
      return tags_[cache_of(kind)].access(node_, line);
    }
    bool touch(memory::RecordKind kind, std::uint32_t line) const {
      return tags_[cache_of(kind)].touch(node_, line);
    }
    [[nodiscard]] bool holds(memory::RecordKind kind, std::uint32_t line) const {
      return tags_[cache_of(kind)].holds(node_, line);
    }
    [[nodiscard]] std::int64_t remove(std::uint32_t line) const {
      return remove_each(line, [](std::size_t /*cache*/, bool /*held*/) {});
    }
    /// As remove(); calls told(cache, held) for the number of each cache and whether it held the line.
    template <class Told>
    std::int64_t remove_each(std::uint32_t line, const Told& told) const {
      std::int64_t copies = 0;
      for (std::size_t cache = 0; cache < tags_.size(); ++cache) {
        const bool held = tags_[cache].remove(node_, line);
        copies += held ? 1 : 0;
        told(cache, held);
      }
      return copies;
    }
    /// The number of the cache that a record kind uses: 0 with one cache, split_cache_of[kind] with four.
    [[nodiscard]] std::size_t cache_of(memory::RecordKind kind) const {
      return tags_.size() > 1 ? split_cache_of[static_cast<std::size_t>(kind)] : 0;
    }

   private:
    std::vector<memory::TagArray>& tags_;
    std::uint32_t node_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {tags_, node}; }

 private:
  static std::vector<memory::TagArray> tags_of(const machine::MachineConfig& config) {
    std::vector<memory::TagArray> tags;
    for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
      tags.emplace_back(first.cache, config.all_nodes());
    }
    return tags;
  }

  std::vector<memory::TagArray> tags_;
};

/// Unified caches that never replace a line: see ReplayInput::line_set.
class NonReplacingCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = false;
  NonReplacingCaches(const machine::MachineConfig& config, std::uint64_t lines)
      : lines_(lines, config.all_nodes()) {}
  class View {
   public:
    View(memory::LineSet& lines, std::uint32_t node) : lines_(&lines), node_(node) {}
    [[gnu::always_inline]] bool access(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return lines_->access(node_, line);
    }

   private:
    memory::LineSet* lines_;
    std::uint32_t node_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {lines_, node}; }

 private:
  memory::LineSet lines_;
};

/// Nodes without a cache: every reference misses, and only its own bytes are moved.
struct NoCaches {
  static constexpr bool present = false;
  static constexpr bool by_kind = false;
  struct View {
    static bool access(memory::RecordKind /*kind*/, std::uint32_t /*line*/) { return false; }
    static bool touch(memory::RecordKind /*kind*/, std::uint32_t /*line*/) { return false; }
    static bool holds(memory::RecordKind /*kind*/, std::uint32_t /*line*/) { return false; }
    static std::int64_t remove(std::uint32_t /*line*/) { return 0; }
    static std::size_t cache_of(memory::RecordKind /*kind*/) { return 0; }
  };
  [[nodiscard]] static View view(std::uint32_t /*node*/) { return {}; }
};

}  // namespace marti::processors::walk
