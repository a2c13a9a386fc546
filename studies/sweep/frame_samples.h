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

namespace marti::studies {

/// A frame traced small.
struct SmallLog {
  std::shared_ptr<const processors::WorkLog> log;
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
  /// begun any more when `enough()`.
  FrameSamples(const SweepPlan& plan, std::vector<std::size_t> frames, const std::function<bool()>& enough);

  [[nodiscard]] const std::vector<FrameSample>& samples() const { return samples_; }
  /// One for each of `frames`.
  [[nodiscard]] std::vector<FrameEstimate> estimates() const;

 private:
  void take_next();

  const SweepPlan& plan_;
  std::vector<std::size_t> frames_;
  std::vector<std::vector<std::uint64_t>> settings_;  // of each frame, hashed, ascending
  std::vector<std::size_t> unlike_;                   // settings that its sample has otherwise
  std::vector<std::size_t> nearest_;                  // index into samples_
  std::vector<FrameSample> samples_;
};

}  // namespace marti::studies
