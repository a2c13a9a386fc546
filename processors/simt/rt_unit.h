// What the ray-tracing unit of a SimtNode keeps: accesses, which lanes share, and tests. Its steps are in
// rt_unit.cpp.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/simt/warp.h"

namespace marti::processors::simt {

/// Lanes of one warp.
struct WarpLanes {
  std::uint32_t warp = 0;
  Lanes lanes = 0;
};

/// Lanes that get a record together.
struct Access {
  std::vector<WarpLanes> lanes;
  memory::RecordKind kind = memory::RecordKind::node;
  walk::Origin origin{};        ///< of the lane that decided
  std::size_t lane = 0;         ///< where lists of all lanes have the one whose ray that is
  std::uint32_t next_unit = 0;  ///< lines from here to last_unit are still to be looked up
  std::uint32_t last_unit = 0;
  bool sent = false;                       ///< all were
  std::uint32_t pending = 0;               ///< lines that were looked up and are not there
  std::uint32_t left = 0;                  ///< of these, lines that left the node
  std::int64_t count = 0;                  ///< of all lanes
  LaneState state = LaneState::scheduler;  ///< of all lanes
};

/// Lanes of a warp that test together.
struct RunningTest {
  WarpLanes lanes;
  LaneState state = LaneState::box;
};

/// A lane that waits for a test unit.
struct WaitingTest {
  std::uint64_t entered = 0;  ///< of its warp
  std::uint32_t warp = 0;
  std::uint32_t lane = 0;
  std::int64_t cycles = 0;

  friend bool operator<(const WaitingTest& a, const WaitingTest& b) {
    return a.entered != b.entered ? a.entered < b.entered : a.lane < b.lane;
  }
};

}  // namespace marti::processors::simt
