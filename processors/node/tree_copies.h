// How far each copy of a tree has been built: the state of its lazy branches, and which lines of memory may
// still be written. States only advance: P, being built, built for branches; open, settled for lines.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/walk/tree_plan.h"

namespace marti::processors::node {

/// Which lines of one copy are settled, that is, have their final content. Lines are those of the caches, or
/// interleave units without a cache.
struct LineStates {
  const std::uint32_t* open = nullptr;  ///< for each line: records and lists in it that are not final
  std::uint32_t initial_end = 0;  ///< one past the last line of the node section; 0 when nothing is open
  std::uint32_t lower_begin = 0xffffffffU;   ///< first line of the blocks
  const std::uint32_t* allocated = nullptr;  ///< one past the last line completely in allocated blocks

  [[nodiscard]] bool settled(std::uint32_t line) const {
    if (line < initial_end) {
      return open[line] == 0;
    }
    return line < lower_begin || (line < *allocated && open[initial_end + (line - lower_begin)] == 0);
  }
};

/// All copies: one for each cluster when trees are shared, one for each processor node when private.
class TreeCopies {
 public:
  /// Bytes of the host's memory that the copies of a machine take. `plan` must have been placed.
  [[nodiscard]] static std::uint64_t host_bytes(const walk::TreePlan& plan, const memory::Layout& layout,
                                                const machine::MachineConfig& config);

  /// Throws KeyError when the copies would take more than `most_bytes` of the host's memory.
  TreeCopies(const walk::TreePlan& plan, const accel::Topology& topology, const memory::Layout& layout,
             const machine::MachineConfig& config);

  /// The copy that a processor node reads.
  [[nodiscard]] std::uint32_t copy_of(std::uint32_t processor) const {
    return private_ ? processor : processor / nodes_;
  }
  [[nodiscard]] std::uint32_t copies() const { return copies_; }

  [[nodiscard]] bool taken(std::uint32_t copy, std::uint32_t lazy) const {
    return block_[at(copy, lazy)] != 0;
  }
  [[nodiscard]] bool built(std::uint32_t copy, std::uint32_t lazy) const {
    return built_[at(copy, lazy)] != 0;
  }
  /// Address of a branch's block; a processor must have taken the branch.
  [[nodiscard]] memory::Address block(std::uint32_t copy, std::uint32_t lazy) const {
    return block_[at(copy, lazy)];
  }
  /// Who took the branch: what take() was told; for shared trees only.
  [[nodiscard]] std::uint32_t builder(std::uint32_t copy, std::uint32_t lazy) const {
    return builder_[at(copy, lazy)];
  }

  /// `builder` begins to split the branch: its block is allocated.
  void take(std::uint32_t copy, std::uint32_t lazy, std::uint32_t builder);
  /// Makes the branch's children visible.
  void publish(std::uint32_t copy, std::uint32_t lazy);

  [[nodiscard]] LineStates lines(std::uint32_t copy) const;
  /// Notes that some cache of the cluster holds a line that is not settled.
  void note_cached(std::uint32_t copy, std::uint32_t line);
  /// Whether some cache of the cluster may hold the line.
  [[nodiscard]] bool maybe_cached(std::uint32_t copy, std::uint32_t line) const;

  /// Host bytes a replay may take for the state of all copies.
  static constexpr std::uint64_t most_bytes = std::uint64_t{4} << 30U;

 private:
  // Which of a copy's lines are kept track of, for shared trees: those of the node section, then those of the
  // blocks.
  struct Lines {
    std::uint32_t initial = 0;
    std::uint32_t lower_begin = 0xffffffffU;
    std::size_t all = 0;
  };
  static Lines lines_of(const walk::TreePlan& plan, const memory::Layout& layout,
                        const machine::MachineConfig& config);
  [[nodiscard]] std::size_t at(std::uint32_t copy, std::uint32_t lazy) const {
    return std::size_t{copy} * lazies_ + lazy;
  }
  [[nodiscard]] std::size_t index_of(std::uint32_t copy, std::uint32_t line) const;
  // Adds `by` to the number of open records and lists in each line that these bytes touch.
  void count_open(std::uint32_t copy, memory::Address begin, std::uint64_t bytes, std::int32_t by);

  const walk::TreePlan& plan_;
  const accel::Topology& topology_;
  bool private_;
  std::uint32_t nodes_;
  std::uint32_t copies_;
  std::size_t lazies_;
  unsigned line_shift_;
  std::uint64_t node_bytes_;
  std::vector<memory::Address> block_;  // 0: the branch is a P node
  std::vector<std::uint8_t> built_;
  std::vector<std::uint32_t> builder_;
  std::vector<memory::Address> next_;  // for each copy: the address of its next block
  Lines lines_;
  std::vector<std::uint32_t> open_;
  std::vector<std::uint8_t> cached_;
  std::vector<std::uint32_t> allocated_;
  memory::Address node_section_ = 0;
};

}  // namespace marti::processors::node
