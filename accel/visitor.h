// A traversal reports its steps to a visitor, in order, so that one traversal serves rendering, recording and
// counting.
#pragma once

#include <cstdint>

namespace marti::accel {

/// The visitor that does nothing and costs nothing. Others have the same members; mailed_leaf only if they
/// have mailboxes (mailbox.h).
struct NullVisitor {
  /// A branch node's record was read and its children are about to be entered.
  void branch(std::uint32_t /*node*/) {}
  /// A leaf's record was read, then the first `tests` of its `entries` objects were tested, in list
  /// order. tests < entries only when an occlusion query ended early.
  void leaf(std::uint32_t /*node*/, std::uint32_t /*tests*/, std::uint32_t /*entries*/) {}
  /// Only with the voxel cut (octree_cut.h): a node's record was read and the ray sees the whole node as a
  /// voxel.
  void cut(std::uint32_t /*node*/) {}
  /// Only with the voxel cut: a small node's voxel was read, but too little of it is covered; branch or leaf
  /// follows.
  void pass(std::uint32_t /*record*/) {}
  /// As leaf(), where mailboxes left tests out: among the first `read` entries those were tested whose bit is
  /// set in `tested`; the bit of entry k is bit k % 32 of word k / 32.
  void mailed_leaf(std::uint32_t /*node*/, std::uint32_t /*read*/, std::uint32_t /*entries*/,
                   const std::uint32_t* /*tested*/) {}
};

}  // namespace marti::accel
