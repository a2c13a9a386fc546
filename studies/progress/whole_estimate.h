// How long the whole of some work takes, whose parts come one after the other: those to come as was foreseen,
// the present one by its own pace, the more the further it is.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "sim/work_meter.h"

namespace marti::studies::progress {

struct ForeseenPart {
  std::string name;      ///< how what the meter calls the part begins: "building"
  double seconds = 0.0;  ///< as people wait
  bool counted = true;   ///< its steps take about equally long, and all of them are done
};

/// What is known of the parts of the work that a meter tells of. Thread-safe.
class Foreseen {
 public:
  /// In place of what was known before.
  void say(std::vector<ForeseenPart> parts) {
    const std::lock_guard lock(mutex_);
    parts_ = std::move(parts);
  }
  [[nodiscard]] std::vector<ForeseenPart> parts() const {
    const std::lock_guard lock(mutex_);
    return parts_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<ForeseenPart> parts_;
};

class WholeEstimate {
 public:
  /// Seconds of the whole work, of which `passed` are over; 0 when the present part was not foreseen.
  /// Calls come in the order of time; each is told how far the work is then.
  [[nodiscard]] double seconds(const sim::WorkMeter::State& state, const std::vector<ForeseenPart>& parts,
                               double passed);

 private:
  void finish_parts_before(std::size_t part, double passed);

  std::vector<ForeseenPart> parts_;  // as foreseen when the present part was seen last
  std::size_t part_ = 0;             // the present one
  double begun_ = 0.0;               // when it was seen first
  double took_ = 0.0;                // the parts before it
  double foreseen_ = 0.0;            // what had been foreseen for these
};

}  // namespace marti::studies::progress
