// What is kept of a timed machine: its counters, summed over its nodes, and its histograms of waits; and what
// is kept of a frame. parts() is for their bytes (sweep/plan/byte_codec.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"
#include "studies/figures/counted_figures.h"
#include "studies/run/frame_figures.h"
#include "studies/run/functional_run.h"

namespace marti::studies::sweep {

/// Some waits of a machine, log-scaled. Only buckets that hold something.
struct SweepHistogram {
  std::string what;  ///< one of sweep_histogram_names()
  struct Bucket {
    std::int64_t lowest = 0;  ///< ps
    std::int64_t highest = 0;
    std::int64_t count = 0;
    bool operator==(const Bucket&) const = default;
    static auto parts(auto& bucket) { return std::tie(bucket.lowest, bucket.highest, bucket.count); }
  };
  std::vector<Bucket> buckets;
  bool operator==(const SweepHistogram&) const = default;
  static auto parts(auto& histogram) { return std::tie(histogram.what, histogram.buckets); }
};

struct SweepRow {
  figures::Counts counters;  ///< one for each of counted_figures()
  std::vector<SweepHistogram> histograms;
  bool operator==(const SweepRow&) const = default;
  static auto parts(auto& row) { return std::tie(row.counters, row.histograms); }
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
  static auto parts(auto& row) {
    return std::tie(row.counters, row.scene, row.scene_hash, row.image_hash, row.hit_hash, row.notes);
  }
};

/// `scene_hash` is that of the scene as opened (studies/run/scene_hash.h).
[[nodiscard]] FrameRow frame_row(const run::FunctionalRun& run, std::uint64_t scene_hash);

}  // namespace marti::studies::sweep
