// Where the records lie of a tree that is built partly before the frame and partly during it. What exists
// when the frame begins lies in the database's sections; everything made later lies behind the frame buffer.
//
// The dynamic region begins at the first multiple of section alignment and cache line behind the frame
// buffer:
//   1. lists of branches that are split beforehand, in the order of their splits; nobody reads them later
//   2. private trees only: a record (`slot`) for each P node of the initial tree
//   3. blocks, in the order in which branches are taken to be split: the records of the children, then their
//      lists, child by child. A block starts on a multiple of the record alignment.
// With private trees parts 2 and 3 are in every processor node's own memory, at the same addresses in each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/topology.h"
#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/walk/build_start.h"
#include "processors/walk/visit_plan.h"

namespace marti::processors::walk {

class TreePlan {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Where one tree node lies. `home` is the lazy number of its parent; `none` for the root and when the
  /// parent is split before the frame: then the node is one of the initial tree.
  struct Place {
    std::uint32_t home = none;
    std::uint32_t record = 0;   ///< initial: its record in the node section; else its number as a child
    std::uint32_t lazy = none;  ///< its own number among the lazy branches
    /// Where its list is. Initial: the first entry in the list section, or for a branch split before the
    /// frame the offset in the dynamic region. Else the offset in its parent's block.
    std::uint64_t list = 0;
  };
  struct LazyBranch {
    std::uint32_t node = 0;
    std::uint32_t slot = none;  ///< of a P node of the initial tree
    std::uint64_t block_bytes = 0;
  };

  /// `starts` must have passed check_starts.
  TreePlan(const accel::Topology& topology, std::vector<BranchStart> starts,
           const machine::MachineConfig& config);

  /// Number of records and entries of the initial tree, for the layout's sections.
  [[nodiscard]] std::uint64_t initial_nodes() const { return initial_nodes_; }
  [[nodiscard]] std::uint64_t initial_entries() const { return initial_entries_; }
  /// Fixes the dynamic region behind the sections. Call it once, before the functions below.
  void place_behind(const memory::Layout& layout, std::uint32_t line_bytes);

  [[nodiscard]] const Place& place(std::uint32_t node) const { return places_[node]; }
  [[nodiscard]] std::span<const LazyBranch> lazy() const { return lazy_; }
  /// Branches split before the frame, in the order of their numbers: breadth first.
  [[nodiscard]] std::span<const std::uint32_t> eager() const { return eager_; }
  [[nodiscard]] BranchStart start(std::uint32_t node) const { return starts_[node]; }
  /// Number of primitives that a node lists.
  [[nodiscard]] std::uint32_t listed(std::uint32_t node) const;
  /// Whether the node's list is written by a processor, because its parent is split. The root's list and
  /// those below kept branches come with the database.
  [[nodiscard]] bool list_is_written(std::uint32_t node) const { return written_[node]; }
  [[nodiscard]] std::uint32_t slots() const { return slots_; }

  /// First byte of part 1, first byte of part 2, and one past the last byte that part 3 can ever take.
  [[nodiscard]] memory::Address dynamic_base() const { return dynamic_base_; }
  [[nodiscard]] memory::Address lower_base() const { return lower_base_; }
  [[nodiscard]] memory::Address end() const { return end_; }
  [[nodiscard]] memory::Address slot_address(std::uint32_t slot) const {
    return lower_base_ + slot * stride_;
  }
  /// Address of the first block.
  [[nodiscard]] memory::Address first_block() const { return slot_address(slots_); }
  [[nodiscard]] std::uint64_t stride() const { return stride_; }  ///< of node records

 private:
  void number_records(const machine::MachineConfig& config);
  void place_lists(const machine::MachineConfig& config);

  const accel::Topology& topology_;
  std::vector<BranchStart> starts_;
  std::vector<Place> places_;
  std::vector<bool> written_;
  std::vector<LazyBranch> lazy_;
  std::vector<std::uint32_t> eager_;
  std::uint64_t initial_nodes_ = 0;
  std::uint64_t initial_entries_ = 0;
  std::uint64_t eager_list_bytes_ = 0;
  std::uint64_t all_block_bytes_ = 0;
  std::uint32_t slots_ = 0;
  std::uint64_t stride_ = 1;
  std::uint64_t section_alignment_;
  std::uint64_t record_alignment_;
  memory::Address dynamic_base_ = 0;
  memory::Address lower_base_ = 0;
  memory::Address end_ = 0;
};

/// The visits to nodes of the initial tree other than P nodes; the visits to all others have no lines.
[[nodiscard]] VisitPlan plan_initial_visits(const TreePlan& plan, const program::WorkLog& log,
                                            const memory::Layout& layout, unsigned line_shift,
                                            const cost::StepTicks& ticks);

}  // namespace marti::processors::walk
