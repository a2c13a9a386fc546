// Which lines are prefetched.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/walk/node_order.h"
#include "processors/walk/replay_input.h"

namespace marti::processors::walk {

/// The bytes that a record takes.
struct RecordBytes {
  memory::Address at = 0;
  std::uint32_t bytes = 0;
};

/// Calls visit(line) for the lines of `count` records, in ascending order, until one call returns false;
/// returns the last call's result, or true without records. record_of(i) is record i, whose address ascends,
/// or none for a record that is left out. `shift`: a line has 2^shift bytes.
template <class RecordOf, class Visit>
bool each_line_of(std::uint32_t count, unsigned shift, const RecordOf& record_of, const Visit& visit) {
  std::uint32_t from = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::optional<RecordBytes> record = record_of(i);
    if (!record) {
      continue;
    }
    const auto first = static_cast<std::uint32_t>(record->at >> shift);
    const auto last = static_cast<std::uint32_t>((record->at + record->bytes - 1) >> shift);
    for (std::uint32_t line = first < from ? from : first; line <= last; ++line) {
      if (!visit(line)) {
        return false;
      }
    }
    from = last + 1;
  }
  return true;
}

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
  bool each_child_line(std::uint32_t branch, const Visit& visit) const {
    const accel::TopologyNode& node = input_.log.topology.nodes[branch];
    // Transforms lie behind all records of nodes.
    return each_line_of(
        instances_ ? 2 * node.count : node.count, shift_,
        [&](std::uint32_t number) -> std::optional<RecordBytes> {
          const bool instance = number >= node.count;
          const std::uint32_t child = node.first + (instance ? number - node.count : number);
          const std::uint32_t record = input_.node_rank.empty() ? child : input_.node_rank[child];
          if (record == no_record || (instances_ && input_.log.topology.nodes[child].instance != instance)) {
            return std::nullopt;
          }
          const auto kind = instance ? memory::RecordKind::transform : memory::RecordKind::node;
          return RecordBytes{input_.layout.address(kind, record), input_.layout.record_bytes(kind)};
        },
        visit);
  }

 private:
  ReplayInput input_;
  bool instances_;  ///< whether there are any
  unsigned shift_;
};

}  // namespace marti::processors::walk
