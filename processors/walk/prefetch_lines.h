// Which lines are prefetched.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/walk/node_order.h"
#include "processors/walk/replay_input.h"

namespace marti::processors::walk {

/// Calls visit(line) for the lines of `count` records of `bytes` each, in ascending order, until one call
/// returns false; returns the last call's result, or true without records. address_of(i) is the address of
/// record i, which ascends, or none for a record that is left out. `shift`: a line has 2^shift bytes.
template <class AddressOf, class Visit>
bool each_line_of(std::uint32_t count, std::uint32_t bytes, unsigned shift, const AddressOf& address_of,
                  const Visit& visit) {
  std::uint32_t from = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::optional<memory::Address> address = address_of(i);
    if (!address) {
      continue;
    }
    const auto first = static_cast<std::uint32_t>(*address >> shift);
    const auto last = static_cast<std::uint32_t>((*address + bytes - 1) >> shift);
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
    return each_line_of(
        node.count, node_bytes_, shift_,
        [&](std::uint32_t number) -> std::optional<memory::Address> {
          const std::uint32_t child = node.first + number;
          const std::uint32_t record = input_.node_rank.empty() ? child : input_.node_rank[child];
          return record == no_record ? std::nullopt
                                     : std::optional(input_.layout.address(memory::RecordKind::node, record));
        },
        visit);
  }

 private:
  ReplayInput input_;
  std::uint32_t node_bytes_;
  unsigned shift_;
};

}  // namespace marti::processors::walk
