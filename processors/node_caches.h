// The private caches of all nodes, as the node's inner loop sees them: one call that says hit or miss.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "memory/line_set.h"
#include "memory/record_kind.h"
#include "memory/tags.h"
#include "processors/machine_config.h"

namespace marti::processors {

/// Which of the split caches a record kind uses.
inline constexpr std::array<std::uint8_t, memory::record_kinds> split_cache_of = {0, 1, 2, 3, 3, 3};

/// One tag store for a unified cache.
template <class Tags>
class UnifiedCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = false;  ///< the record kind does not matter
  UnifiedCaches(const MachineConfig& config, const memory::CacheShape& shape)
      : tags_(shape, config.all_nodes(), config.cache.cache.seed) {}
  class View {
   public:
    explicit View(typename Tags::View tags) : tags_(tags) {}
    [[gnu::always_inline]] bool access(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return tags_.access(line);
    }
    /// The same, but a line that is not there is not brought in.
    [[gnu::always_inline]] bool touch(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return tags_.touch(line);
    }
    /// Whether a line is there; changes nothing.
    [[nodiscard]] bool holds(memory::RecordKind /*kind*/, std::uint32_t line) const {
      return tags_.holds(line);
    }
    /// Takes a line out, whatever kinds of record it holds; how many copies there were.
    [[nodiscard]] std::int64_t remove(std::uint32_t line) const { return tags_.remove(line) ? 1 : 0; }

   private:
    typename Tags::View tags_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return View(tags_.view(node)); }

 private:
  Tags tags_;
};

/// One tag store for each of the split caches.
template <class Tags>
class SplitCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = true;
  SplitCaches(const MachineConfig& config, const std::array<memory::CacheShape, split_caches>& shapes) {
    tags_.reserve(split_caches);
    for (const memory::CacheShape& shape : shapes) {
      tags_.emplace_back(shape, config.all_nodes(), config.cache.cache.seed);
    }
  }
  class View {
   public:
    View(std::vector<Tags>& tags, std::uint32_t node) : tags_(tags), node_(node) {}
    bool access(memory::RecordKind kind, std::uint32_t line) const {
      return tags_[split_cache_of[static_cast<std::size_t>(kind)]].view(node_).access(line);
    }
    bool touch(memory::RecordKind kind, std::uint32_t line) const {
      return tags_[split_cache_of[static_cast<std::size_t>(kind)]].view(node_).touch(line);
    }
    [[nodiscard]] bool holds(memory::RecordKind kind, std::uint32_t line) const {
      return tags_[split_cache_of[static_cast<std::size_t>(kind)]].view(node_).holds(line);
    }
    [[nodiscard]] std::int64_t remove(std::uint32_t line) const {
      std::int64_t removed = 0;
      for (Tags& tags : tags_) {
        removed += tags.view(node_).remove(line) ? 1 : 0;
      }
      return removed;
    }

   private:
    std::vector<Tags>& tags_;
    std::uint32_t node_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {tags_, node}; }

 private:
  std::vector<Tags> tags_;
};

/// Unified caches that never replace a line, as ReplayInput::line_set says.
class RoomyCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = false;
  RoomyCaches(const MachineConfig& config, std::uint64_t lines) : lines_(lines, config.all_nodes()) {}
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
  };
  [[nodiscard]] static View view(std::uint32_t /*node*/) { return {}; }
};

}  // namespace marti::processors
