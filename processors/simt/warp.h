// A warp: its packet, its phase, and its part of the ray-tracing unit.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "processors/machine/packets.h"
#include "processors/simt/node_time.h"
#include "processors/walk/attribution.h"
#include "processors/walk/observer.h"

namespace marti::processors::simt {

/// A bit for each lane of a warp.
using Lanes = std::uint64_t;

[[nodiscard]] inline std::int64_t count(Lanes lanes) { return std::popcount(lanes); }
/// Calls use(lane number) for each lane, the lowest first.
template <class Use>
void for_each_lane(Lanes lanes, const Use& use) {
  for (; lanes != 0; lanes &= lanes - 1) {
    use(static_cast<std::uint32_t>(std::countr_zero(lanes)));
  }
}

/// The lowest so many lanes, at most 64.
[[nodiscard]] inline Lanes lowest(std::uint32_t lanes) {
  return lanes == 64 ? ~Lanes{0} : (Lanes{1} << lanes) - 1;
}

/// A packet's pixel by its number, row by row.
[[nodiscard]] inline walk::PixelPlace pixel_of(const machine::Packet& packet, std::uint32_t number) {
  const std::uint32_t columns = packet.x1 - packet.x0;
  return {packet.x0 + number % columns, packet.y0 + number / columns};
}

/// A line that is to be looked up.
struct LineRead {
  std::uint32_t unit = 0;  ///< address divided by MachineConfig::reference_bytes()
  memory::RecordKind kind = memory::RecordKind::node;
  walk::Origin origin{};  ///< of the first lane that reads it
  std::size_t lane = 0;   ///< where lists of all lanes have that
};

/// Of pixels, or of a line of a lane's stack.
struct Write {
  memory::Address at = 0;
  std::uint32_t bytes = 0;
  bool pixels = true;
};

/// What a warp does: it has no packet, or none is left; it is in a shader phase, or in a round of tracing
/// without a unit; it waits for the unit, or is in it; it writes the pixels that have ended.
enum class Does : std::uint8_t { nothing, shading, round, waits_for_unit, traces, writing };

/// Of a phase, or a round, that computes: not at all, when its lines are there, when it gets a slot, now, or
/// no longer.
enum class Computing : std::uint8_t { none, reads, waits, runs, over };

struct Warp {
  Does does = Does::nothing;
  machine::Packet packet;
  std::int64_t packet_began = 0;
  bool over = false;  ///< none is left for it
  std::uint32_t turn = 0;
  Lanes pixels = 0;   ///< lanes that have a pixel in this turn
  Lanes rays = 0;     ///< lanes that hold a ray
  Lanes members = 0;  ///< lanes of the phase or round, or those that trace
  Lanes picked = 0;   ///< lanes of the trace phase, which make the shader phase after it
  Lanes ended = 0;    ///< lanes whose pixels have ended in the shader phase

  // Of a phase or a round.
  std::int64_t began = 0;
  ComputeCycles compute;
  Computing computing = Computing::none;
  std::vector<LineRead> lines;
  std::size_t next_line = 0;
  std::uint32_t pending = 0;  ///< lines that were looked up and are not there
  std::uint32_t left = 0;     ///< of these, lines that left the node

  // Of a trace phase.
  std::int64_t trace_began = 0;
  Lanes wants = 0;             ///< lanes that want a record, in the unit
  Lanes tracing = 0;           ///< lanes that are not done
  std::uint32_t slot = 0;      ///< of the unit
  std::uint64_t entered = 0;   ///< how many warps had entered the unit before
  std::uint32_t pooled = 0;    ///< rays that wait to be sorted
  std::uint32_t away = 0;      ///< rays that do, or are in a sorted group that has not left the unit
  std::uint32_t unposted = 0;  ///< lines of its lanes' stacks that wait for the write buffer

  std::vector<Write> writes;
  std::size_t next_write = 0;

  LaneState state = LaneState::held;  ///< of `state_lanes`, which are counted as such; others are held
  Lanes state_lanes = 0;
};

}  // namespace marti::processors::simt
