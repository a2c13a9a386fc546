// Where a node is in its work on a machine whose tree is built while it is used.
#pragma once

#include <cstdint>

#include "memory/record_kind.h"
#include "processors/machine/packets.h"
#include "processors/walk/attribution.h"
#include "sim/time.h"

namespace marti::processors::node {

/// What the node does after it has read or written the bytes from DynamicCursor::at to `end`.
enum class Todo : std::uint8_t {
  step,     ///< take the next step of the log, or the next branch to split before the frame
  list,     ///< a leaf's record was read: read its list
  tests,    ///< test the next primitive of the leaf
  branch,   ///< a lazy branch's record was read: see whether the branch is built
  inherit,  ///< a private tree's slot was empty and the shared record was read: split the branch
  voxel,    ///< the record of a node that is shaded as one voxel was read; it may remain a P node
  lock,     ///< the lock transaction is under way
  split,    ///< a branch to be split before the frame was read: split it
  sort,     ///< the list of the branch was read: read and sort its next primitive
  make,     ///< make the next child: write its list
  record,   ///< the child's list was written: write its record
  publish,  ///< all children were written: write the branch's own record
  done,     ///< the branch's own record was written
};

/// Whether a node at this point reads for the splitting of a branch: what follows a lock in the list above
/// does.
[[nodiscard]] constexpr bool is_for_split(Todo todo) { return todo == Todo::inherit || todo >= Todo::lock; }

/// The result of a lock transaction.
enum class Lock : std::uint8_t { won, wait, built };

struct DynamicCursor {
  sim::Ticks time = 0;
  const std::uint32_t* word = nullptr;
  const std::uint32_t* word_end = nullptr;
  memory::Address at = 0;                ///< next byte to read or write
  memory::Address end = 0;               ///< one past the last byte to read or write
  const std::uint32_t* entry = nullptr;  ///< primitives still to be tested or sorted
  const std::uint32_t* entry_end = nullptr;
  const std::uint32_t* tested = nullptr;  ///< of a mailed leaf: a bit for each entry; null: all are tested
  std::uint32_t node = 0;   ///< the leaf that is tested, or the branch that is looked at or split
  std::uint32_t child = 0;  ///< next child to make
  std::uint32_t children =
      none;                 ///< guarded caches: a branch that was read, whose children may be prefetched
  std::uint32_t eager = 0;  ///< next branch to split before the frame
  std::uint32_t tests = 0;  ///< entries of the leaf's list to read
  std::uint32_t entry_number = 0;  ///< of `entry` in the mailed leaf's list
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t writes = 0;  ///< where the next posted write goes in the write buffer
  machine::Packet packet;
  memory::RecordKind kind = memory::RecordKind::node;
  Todo todo = Todo::step;
  walk::Origin origin;  ///< of the present reference, but for `splitting`; kept only where it is counted
  Lock lock = Lock::won;
  bool writing = false;  ///< the bytes are written, not read
  bool due = false;      ///< the simulation has reached the reference that comes next
  bool seen = false;     ///< the lazy branch just read was seen built
  bool before = false;   ///< the node still splits branches before the frame

  static constexpr std::uint32_t none = 0xffffffffU;
};

/// Why a walk stopped. due: the reference at the cursor must wait until the simulation reaches the cursor's
/// time. lock, miss: it needs the interconnect. write: it posts a write, of a pixel when todo is `step`.
/// ready: no branch is left to split before the frame. With guarded caches only: line: the next reference is
/// to a line that may be under way; children: a branch was read whose children are to be prefetched; other:
/// another context of the node splits the branch that the walk has come to, in the node's own tree.
enum class DynamicStop : std::uint8_t { due, miss, lock, write, ready, line, children, other };

}  // namespace marti::processors::node
