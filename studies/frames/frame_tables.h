// The tables of `marti study frames`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/config.h"
#include "studies/frames/frame_sequence.h"
#include "studies/frames/frame_ways.h"
#include "studies/frames/frames_config.h"
#include "studies/tables/table.h"

namespace marti::studies::frames {

/// What an update did to a tree. In a first frame everything was made anew.
struct TreeChange {
  std::uint64_t nodes = 0;       ///< of the new tree
  std::uint64_t branches = 0;    ///< among these nodes
  std::uint64_t moved = 0;       ///< primitives that moved; 0 in a first frame
  std::uint64_t altered = 0;     ///< nodes whose record or list had to be made anew
  std::uint64_t resorted = 0;    ///< branches in which only moved primitives were sorted anew
  std::uint64_t split = 0;       ///< branches whose children were made anew
  std::uint64_t sorted = 0;      ///< primitives sorted by the update, each once a node
  std::uint64_t tests = 0;       ///< overlap tests run by it
  std::uint64_t all_sorted = 0;  ///< primitives sorted by a build from nothing
  std::uint64_t all_tests = 0;
};
[[nodiscard]] TreeChange change_of(const FrameTree& tree);

/// What is kept of a frame when its scene, tree and log are gone.
struct FrameOutcome {
  std::uint32_t number = 0;  ///< as the animation counts
  double seconds = 0.0;      ///< from the animation's beginning
  TreeChange change;
  std::uint64_t hit_hash = 0;
  std::uint64_t image_hash = 0;
  double build_seconds = 0.0;   ///< host: the tree from nothing
  double update_seconds = 0.0;  ///< host: the tree by update
  WayOutcomes ways;
};

/// As the tables have it.
[[nodiscard]] std::string hash_text(std::uint64_t hash);

/// The lines of a report about its `count` frames, its images and its machine. `images`: what is said of
/// these beside their size.
[[nodiscard]] std::string subject_text(const sim::Config& config, const FramesConfig& frames,
                                       std::size_t count, std::string_view images);

/// "X has the shortest cycles, 1.2 s for 7 frames, 3 % less than Y"; without its end where nothing is saved.
[[nodiscard]] std::string shortest_text(std::string_view best, sim::Ticks cycles, std::size_t frames,
                                        double less, std::string_view than);
/// Which way has the shortest cycles, all frames together: one sentence.
[[nodiscard]] std::string ways_answer(std::span<const FrameOutcome> frames);

/// "frames": a row for each frame: what moved, what was altered, hashes.
[[nodiscard]] tables::Table frame_table(std::span<const FrameOutcome> frames);
/// "cycles": a row for each frame and way.
[[nodiscard]] tables::Table cycle_table(std::span<const FrameOutcome> frames);
/// "totals": a row for each way, over all frames.
[[nodiscard]] tables::Table total_table(std::span<const FrameOutcome> frames);
/// "host_frames": seconds of building and of updating on the host.
[[nodiscard]] tables::Table host_frame_table(std::span<const FrameOutcome> frames);

}  // namespace marti::studies::frames
