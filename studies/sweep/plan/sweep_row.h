// What is kept of a timed machine: its counters, summed over its nodes, and its histograms of waits; and what
// is kept of a frame.
#pragma once

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

/// Some waits of a machine, log-scaled. Only buckets that hold something.
struct SweepHistogram {
  std::string what;  ///< one of sweep_histogram_names()
  struct Bucket {
    std::int64_t lowest = 0;  ///< ps
    std::int64_t highest = 0;
    std::int64_t count = 0;
    bool operator==(const Bucket&) const = default;
  };
  std::vector<Bucket> buckets;
  bool operator==(const SweepHistogram&) const = default;
};

struct SweepRow {
  figures::Counts counters;  ///< one for each of counted_figures()
  std::vector<SweepHistogram> histograms;
  std::vector<run::IntervalRow> intervals{};  ///< with record.interval
  bool operator==(const SweepRow&) const = default;
};

/// Names of the histograms that a row can have.
[[nodiscard]] std::span<const std::string_view> sweep_histogram_names();

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
