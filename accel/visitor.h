// A traversal reports its steps to a visitor, in order, so that one traversal serves rendering, recording and
// counting.
#pragma once

#include <concepts>
#include <cstdint>

namespace marti::accel {

/// The children of a branch that a ray enters, in the order in which they are visited, as one word: in its
/// upper four bits how many there are, below, from the lowest bits on, three bits for each with its number
/// among the branch's children.
class EnteredChildren {
 public:
  static constexpr std::uint32_t most = 8;

  EnteredChildren() = default;
  explicit EnteredChildren(std::uint32_t word) : word_(word) {}

  void add(std::uint32_t child) {
    word_ = (word_ | child << (3 * count())) + (std::uint32_t{1} << count_bit);
  }

  [[nodiscard]] std::uint32_t word() const { return word_; }
  [[nodiscard]] std::uint32_t count() const { return word_ >> count_bit; }
  [[nodiscard]] std::uint32_t operator[](std::uint32_t place) const { return (word_ >> (3 * place)) & 7U; }

 private:
  static constexpr unsigned count_bit = 28;

  std::uint32_t word_ = 0;
};

/// Visitors of a bounding volume hierarchy that are told, after branch(), which children of it a ray enters.
/// Not all of them are visited: a hit may turn out to be nearer than the box of one that waits.
template <class Visitor>
concept SeesEntered = requires(Visitor& visitor, EnteredChildren children) {
  { visitor.entered(children) } -> std::same_as<void>;
};

/// The visitor that does nothing and costs nothing. Others have the same members; mailed_leaf only if they
/// have mailboxes (mailbox.h).
struct NullVisitor {
  /// A branch node's record was read and its children are about to be entered.
  void branch(std::uint32_t /*node*/) {}
  /// An instance's transform was read and the ray is about to be brought into its mesh's coordinates; what
  /// follows is in the mesh, up to the next visit to a node of the top level.
  void transform(std::uint32_t /*node*/) {}
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
