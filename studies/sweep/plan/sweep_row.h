// What is kept of a timed machine: its counters, summed over its nodes, and its histograms of waits; and what
// is kept of a frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "studies/figures/counted_figures.h"
#include "studies/run/frame_figures.h"
#include "studies/run/functional_run.h"
#include "studies/run/record/interval_figures.h"

namespace marti::studies::sweep {

/// The waits of a machine whose histograms are kept.
inline constexpr std::array<std::string_view, 4> histogram_names = {"interconnect_wait", "bank_wait",
                                                                    "network_wait", "l2_wait"};

struct SweepRow {
  figures::Counts counters;  ///< one for each of counted_figures()
  /// For each of histogram_names the buckets that hold something, ascending, as JSON: [[lowest, highest,
  /// count], ...] in ps; empty where the machine has no such waits.
  std::array<std::string, histogram_names.size()> histograms{};
  std::vector<run::IntervalRow> intervals{};  ///< with record.interval
  bool operator==(const SweepRow&) const = default;
};

/// Throws InternalError for a sum that does not fit.
[[nodiscard]] SweepRow sweep_row(const processors::machine::MachineConfig& machine,
                                 const processors::replay::MachineResult& result);

/// What is kept of a functional run: counters of its scene, structure, rays and log.
struct FrameRow {
  figures::Counts counters;  ///< one for each of frame_figures()
  std::string scene;         ///< its name
  std::string scene_hash;    ///< 16 hexadecimal digits, like the other hashes
  std::string image_hash;
  std::string hit_hash;
  std::vector<std::string> notes;
  bool operator==(const FrameRow&) const = default;
};

/// `scene_hash` is that of the scene as opened (studies/run/scene_hash.h), or the number of the log that
/// stands in its place.
[[nodiscard]] FrameRow frame_row(const run::FunctionalRun& run, std::uint64_t scene_hash);

}  // namespace marti::studies::sweep
