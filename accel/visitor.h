// A traversal reports what it does to a visitor, in order. One traverser so serves rendering, recording
// and counting.
#pragma once

#include <cstdint>

namespace marti::accel {

/// The visitor that costs nothing. Others have the same two members.
struct NullVisitor {
  /// A branch node's record was read and its children are about to be entered.
  void branch(std::uint32_t /*node*/) {}
  /// A leaf's record was read, then the first `tests` of its `entries` objects were tested, in list
  /// order. tests < entries only when an occlusion query ended early.
  void leaf(std::uint32_t /*node*/, std::uint32_t /*tests*/, std::uint32_t /*entries*/) {}
};

}  // namespace marti::accel
