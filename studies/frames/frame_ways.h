// The four ways to get a frame's tree, each timed on the configured machine.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "accel/octree_update.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/replay/replay.h"

namespace marti::studies::frames {

/// rebuild_all: the whole tree is built before each frame, and its time counts. partial: only altered
/// branches are split before the frame, the rest is kept. dynamic: the initial tree is built before each
/// frame, the rest on demand, from nothing each time. partial_dynamic: what the frame before has built is
/// kept, altered branches are split on demand (frame_sequence.h); its first frame is that of `dynamic`.
enum class FrameWay : std::uint8_t { rebuild_all, partial, dynamic, partial_dynamic };
inline constexpr std::size_t frame_ways = 4;
inline constexpr std::array<std::string_view, frame_ways> frame_way_names = {"rebuild_all", "partial",
                                                                             "dynamic", "partial_dynamic"};

/// One frame on one machine. With several copies of the tree (clusters, private trees) counts and bytes are
/// of all of them together.
struct WayOutcome {
  sim::Ticks build = 0;     ///< before the frame
  sim::Ticks render = 0;    ///< the frame, building on demand included
  sim::Ticks building = 0;  ///< compute time for building, before the frame and in it, all nodes together
  std::int64_t start_up_splits = 0;
  std::int64_t splits = 0;    ///< during the frame
  std::int64_t branches = 0;  ///< B nodes at the end
  std::int64_t partial = 0;   ///< P nodes at the end
  std::int64_t bytes = 0;     ///< records and lists at the end

  [[nodiscard]] sim::Ticks cycle() const { return sim::add_ticks(build, render); }
  [[nodiscard]] std::int64_t all_splits() const { return start_up_splits + splits; }
};
using WayOutcomes = std::array<WayOutcome, frame_ways>;

/// Times frame after frame; what partial_dynamic keeps goes from one to the next.
class FrameWays {
 public:
  /// `machine.build` is that of the ways that build on demand: shared or private.
  explicit FrameWays(const processors::machine::MachineConfig& machine) : machine_(machine) {}

  /// The next frame. `update` is that from the frame before to this one, null for the first. The four are
  /// simulated at the same time; the results do not depend on how many host threads there are.
  [[nodiscard]] WayOutcomes time(const processors::program::WorkLog& log, const accel::OctreeUpdate* update);
  /// What the next frame takes over from the last one. A study that keeps finished frames saves it with each
  /// and puts it back.
  [[nodiscard]] std::vector<std::uint8_t>& built() { return built_; }

 private:
  processors::machine::MachineConfig machine_;
  std::vector<std::uint8_t> built_;  ///< what partial_dynamic's last frame left; see BuildResult::built
};

}  // namespace marti::studies::frames
