// The tables of `marti study frames` with a bounding volume hierarchy.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "processors/cost/tree_work.h"
#include "sim/time.h"
#include "studies/frames/refit_work.h"
#include "studies/tables/table.h"

namespace marti::studies::frames {

struct RefitOutcome {
  processors::cost::LeastTime making;  ///< of the tree, before the frame; of a first frame's, rebuilding it
  sim::Ticks render = 0;
  std::uint64_t records = 0;  ///< of branches and transforms that are written before the frame
  std::uint64_t bytes = 0;    ///< of these
  double cost = 0.0;          ///< Bvh::sah_cost; 0 with kept instances
  double seconds = 0.0;       ///< host: making the tree

  [[nodiscard]] sim::Ticks cycle() const { return sim::add_ticks(making.all(), render); }
};

struct RefitFrame {
  std::uint32_t number = 0;
  double seconds = 0.0;
  std::uint64_t moved = 0;     ///< primitives, in all instances
  std::uint64_t branches = 0;  ///< of the rebuilt tree, its instances among them
  std::uint64_t hit_hash = 0;
  std::uint64_t image_hash = 0;
  std::array<RefitOutcome, refit_ways> ways;

  [[nodiscard]] RefitOutcome& of(RefitWay way) { return ways[static_cast<std::size_t>(way)]; }
  [[nodiscard]] const RefitOutcome& of(RefitWay way) const { return ways[static_cast<std::size_t>(way)]; }
};

/// The first line of the report: which way has the shortest cycles, all frames but the first together, how
/// much shorter than the next, and how many times its least time its trees may take without changing that.
/// Then what refitting saves and costs, and from which frame on it does not pay. `instances`: they are kept,
/// so that there is RefitWay::rebuild_top.
[[nodiscard]] std::vector<std::string> refit_answer(std::span<const RefitFrame> frames, bool instances);

/// "frames": a row for each frame: what moved, hashes.
[[nodiscard]] tables::Table refit_frame_table(std::span<const RefitFrame> frames);
/// "refits": a row for each frame and way.
[[nodiscard]] tables::Table refit_table(std::span<const RefitFrame> frames, bool instances);
/// "totals": a row for each way, over all frames but the first.
[[nodiscard]] tables::Table refit_total_table(std::span<const RefitFrame> frames, bool instances);
/// "host_frames": seconds of making the trees on the host.
[[nodiscard]] tables::Table host_refit_table(std::span<const RefitFrame> frames, bool instances);

}  // namespace marti::studies::frames
