// The tree levels of the steps of a log, by how far a node has come in it.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/program/work_log.h"
#include "processors/walk/cause_observer.h"
#include "sim/error.h"
#include "sim/time.h"

namespace marti::processors {

/// Log and topology must outlive it. Level 1 is the root's; 0 stands for steps that visit no tree node.
class LogLevels {
 public:
  LogLevels(const WorkLog& log, const StepTicks& ticks) : log_(log), ticks_(ticks) {}

  /// The level of the step that the place ends with; 0 for a place in no pixel or before the first step.
  [[nodiscard]] std::uint32_t level_at(LogPlace place);

  /// Divides `traversal`, the traversal time of the steps before `place`, among their levels: calls
  /// add(level, ticks), the last step first, until all of it is divided.
  template <class Add>
  void divide(LogPlace place, sim::Ticks traversal, const Add& add);

 private:
  struct LoggedStep {
    std::uint32_t end = 0;  // number of the pixel's words up to the step's end
    std::uint32_t level = 0;
    sim::Ticks traversal = 0;
  };

  // Makes steps_ those of the pixel; returns the number of them that end at or before the word.
  std::size_t read(LogPlace place);
  [[nodiscard]] sim::Ticks traversal_of(std::uint32_t word) const;

  const WorkLog& log_;
  StepTicks ticks_;
  std::uint32_t pixel_ = LogPlace::nowhere;
  std::vector<LoggedStep> steps_;  // of pixel_
};

template <class Add>
void LogLevels::divide(LogPlace place, sim::Ticks traversal, const Add& add) {
  for (std::size_t step = place.pixel == LogPlace::nowhere ? 0 : read(place); step > 0 && traversal > 0;) {
    --step;
    add(steps_[step].level, steps_[step].traversal);
    traversal -= steps_[step].traversal;
  }
  sim::ensure(traversal == 0, "the steps of a piece of a path do not add up to its length");
}

}  // namespace marti::processors
