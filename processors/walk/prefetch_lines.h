// Which lines are prefetched.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/walk/replay_input.h"

namespace marti::processors {

/// Keeps the references that the input holds.
class PrefetchLines {
 public:
  /// `line_bytes` is a power of two.
  PrefetchLines(const ReplayInput& input, std::uint32_t line_bytes);

  /// The line after `line`, when it holds bytes of the section of `kind`; else std::nullopt.
  [[nodiscard]] std::optional<std::uint32_t> next(memory::RecordKind kind, std::uint32_t line) const;

  /// Calls visit(line) for the lines of the records of a branch's children, in ascending order, until one
  /// call returns false; returns the last call's result, or true when there are no children.
  template <class Visit>
  bool each_child_line(std::uint32_t branch, Visit&& visit) const {
    const accel::TopologyNode& node = input_.log.topology.nodes[branch];
    std::uint32_t from = 0;
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      const std::uint32_t record = input_.node_rank.empty() ? child : input_.node_rank[child];
      const memory::Address address = input_.layout.address(memory::RecordKind::node, record);
      const auto first = static_cast<std::uint32_t>(address >> shift_);
      const auto last = static_cast<std::uint32_t>((address + node_bytes_ - 1) >> shift_);
      for (std::uint32_t line = first < from ? from : first; line <= last; ++line) {
        if (!visit(line)) {
          return false;
        }
      }
      from = last + 1;
    }
    return true;
  }

 private:
  ReplayInput input_;
  std::uint32_t node_bytes_;
  unsigned shift_;
};

}  // namespace marti::processors
