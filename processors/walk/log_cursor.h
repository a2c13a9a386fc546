// Where a node is in its log, and why it stopped there.
#pragma once

#include <cstdint>

#include "memory/record_kind.h"
#include "processors/machine/packets.h"
#include "processors/walk/attribution.h"
#include "sim/time.h"

namespace marti::processors::walk {

/// What the tags of a node hold, for a walk of a stripped log: nothing, as before its first packet; still
/// nothing, although it has begun its first packet; or what it has asked for.
enum class Tags : std::uint8_t { empty, late, present };

/// Where a node is in its packet: the pixel, the word of the pixel's log, and within a step either a line of
/// a planned visit, or a byte of a record and, for a leaf, the objects still to be tested.
struct alignas(64) Cursor {
  // What a walk of a stripped log uses, in one cache line of the host.
  sim::Ticks time = 0;
  const std::uint64_t* stripped = nullptr;  ///< next word of the packet's stripped log, where that is walked
  memory::Address at = 0;                   ///< next byte of the current record
  std::uint32_t writes = 0;                 ///< where the next pixel write goes in the write buffer
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  machine::Packet packet;
  std::uint32_t first_x = 0;  ///< of the node's first packet, with Tags::late
  std::uint32_t first_y = 0;
  Tags tags = Tags::empty;

  const std::uint32_t* word = nullptr;
  const std::uint32_t* word_end = nullptr;
  const std::uint32_t* line = nullptr;  ///< next line of the planned visit
  const std::uint32_t* line_end = nullptr;
  sim::Ticks visit_time = 0;  ///< how much of the planned visit's time is over, as if all its lines had hit
  memory::Address end = 0;    ///< one past the last byte of the current record
  const std::uint32_t* entry = nullptr;
  const std::uint32_t* entry_end = nullptr;
  const std::uint32_t* tested = nullptr;  ///< of a mailed leaf: a bit for each entry; null: all are tested
  std::uint32_t entry_number = 0;         ///< of `entry` in the mailed leaf's list
  std::uint32_t list_count = 0;  ///< entries of the current leaf's list; 0 once the list has been read
  memory::RecordKind kind = memory::RecordKind::node;
  Origin origin;  ///< of the current record; kept only where it is counted
  /// Guarded caches only: the branch whose record was visited last and whose children may be prefetched.
  std::uint32_t branch = no_branch;

  static constexpr std::uint32_t no_branch = 0xffffffffU;
};

/// Why a walk stopped: after a hit (only without running ahead), at a miss, or at the end of its words. due
/// occurs with guarded caches only: the next reference is to a line that may be under way, or a branch was
/// read whose children are to be prefetched.
enum class Stop : std::uint8_t { hit, miss, end, due };

inline void spend(Cursor& cursor, sim::Ticks each, std::int64_t count) {
  cursor.time = sim::add_ticks(cursor.time, sim::multiply_ticks(each, count));
}

/// Moves the cursor within a planned visit to `line`, or to the visit's end, at `time` of the visit; all
/// lines on the way hit.
inline void settle_visit(Cursor& cursor, const std::uint32_t* line, sim::Ticks time) {
  cursor.time = sim::add_ticks(cursor.time, time - cursor.visit_time);
  cursor.visit_time = time;
  cursor.line = line;
}

}  // namespace marti::processors::walk
