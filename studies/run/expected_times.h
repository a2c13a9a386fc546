// How long the parts of a run take on this computer, from what is known so far: at first the size of the file
// and of the image, then the scene, then the time of a small sample of the frame, then its log.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "studies/keys/frame_keys.h"
#include "studies/progress/whole_estimate.h"

namespace marti::studies::run {

class ExpectedTimes {
 public:
  /// `foreseen` is told whenever more is known, and must outlive this object.
  explicit ExpectedTimes(progress::Foreseen& foreseen) : foreseen_(foreseen) {}

  /// `strips`: the machine and one node walk a stripped log. `measures_help`: what would help is measured.
  void begin(const keys::FrameConfig& frame, const processors::machine::MachineConfig& machine, bool strips,
             bool measures_help);
  /// The scene has so many primitives.
  void scene_read(std::uint64_t primitives);
  /// Tracing so many camera rays, spread over the image, took `seconds` and these steps.
  void sampled(std::uint64_t rays, double seconds, const processors::program::LogTotals& totals);
  void tracing_begins();
  /// The log is there.
  void traced(const processors::program::LogTotals& totals);
  /// The machine is timed.
  void timed();

 private:
  void say() const;

  progress::Foreseen& foreseen_;
  std::string structure_;
  double reading_ = 0.0;     // seconds
  double primitives_ = 0.0;  // of the scene
  double rays_ = 0.0;        // camera rays of the frame
  double ray_seconds_ = 0.0;
  double ray_steps_ = 0.0;
  double stripping_ = 0.0;  // seconds a step, as the next
  double timing_ = 0.0;
  bool even_packets_ = false;  // packets that were timed tell how long others take
  bool measures_help_ = false;
  std::chrono::steady_clock::time_point begun_;  // tracing
  std::optional<double> taken_;                  // seconds from then until the machine was timed
};

}  // namespace marti::studies::run
