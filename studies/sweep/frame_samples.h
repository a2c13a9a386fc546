// Some frames of a sweep, traced small: what each frame of the sweep will take, judged by the sample it is
// most like.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "processors/program/work_log.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

/// The most memory that a sample may take: scene and structure, or the machine that is timed on its log. It
/// bounds the time that a sample takes by what is sampled, not by a clock.
inline constexpr std::uint64_t most_sample_bytes = std::uint64_t{250} << 20U;

/// A frame traced small.
struct SmallLog {
  std::shared_ptr<const processors::program::WorkLog> log;
  double bytes = 0.0;
};

/// A frame traced with few pixels and with a quarter of these: what grows with the image shows between the
/// two. All seconds are processor time, of all threads together.
struct FrameSample {
  SmallLog large;
  SmallLog small;                ///< without a log where the frame itself is as small as `large`
  double rays = 0.0;             ///< from the camera, of `large`
  double prepare_seconds = 0.0;  ///< to read the scene and build its structure, the same at any size
  double trace_seconds = 0.0;    ///< of `large`
};

/// What a frame will take at its own size.
struct FrameEstimate {
  std::size_t sample = 0;  ///< index into FrameSamples::samples()
  double scale = 0.0;      ///< how many times as many camera rays as the sample's `large`
  double prepare_seconds = 0.0;
  double trace_seconds = 0.0;
  double log_bytes = 0.0;
};

class FrameSamples {
 public:
  /// Of `frames`, at least one. Sampled next is the frame that has the most settings unlike those of every
  /// sample, where another scene counts more than all other settings. One is always sampled; then none is
  /// begun any more when `enough()`, nor after a frame that takes more than most_sample_bytes.
  FrameSamples(const SweepPlan& plan, std::vector<std::size_t> frames, const std::function<bool()>& enough);

  /// Whether a frame that was to be sampled takes more than most_sample_bytes.
  [[nodiscard]] bool too_large() const { return too_large_; }
  [[nodiscard]] const std::vector<FrameSample>& samples() const { return samples_; }
  /// One for each of `frames`, unless too_large().
  [[nodiscard]] std::vector<FrameEstimate> estimates() const;

 private:
  void take_next();

  bool too_large_ = false;

  const SweepPlan& plan_;
  std::vector<std::size_t> frames_;
  std::vector<std::vector<std::uint64_t>> settings_;  // of each frame, hashed, ascending
  std::vector<std::size_t> unlike_;                   // settings that its sample has otherwise
  std::vector<std::size_t> nearest_;                  // index into samples_
  std::vector<FrameSample> samples_;
};

}  // namespace marti::studies::sweep
