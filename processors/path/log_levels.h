// The tree levels of the steps of a log, by how far a node has come in it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processors/cost/step_time.h"
#include "processors/program/work_log.h"
#include "processors/walk/cause_observer.h"
#include "sim/error.h"
#include "sim/time.h"

namespace marti::processors::path {

/// Log and topology must outlive it. Level 1 is the root's; 0 stands for steps that visit no tree node.
class LogLevels {
 public:
  LogLevels(const program::WorkLog& log, const cost::StepTicks& ticks)
      : log_(log), ticks_(ticks), pixels_(remembered) {}

  /// The level of the step that the place ends with; 0 for a place in no pixel or before the first step.
  [[nodiscard]] std::uint32_t level_at(walk::LogPlace place);

  /// Divides `traversal`, the traversal time of the steps before `place`, among their levels: calls
  /// add(level, ticks), the last step first, until all of it is divided.
  template <class Add>
  void divide(walk::LogPlace place, sim::Ticks traversal, const Add& add);

 private:
  struct LoggedStep {
    std::uint32_t end = 0;  // number of the pixel's words up to the step's end
    std::uint32_t level = 0;
    sim::Ticks traversal = 0;
  };

  struct Pixel {
    std::uint32_t number = walk::LogPlace::nowhere;
    std::vector<LoggedStep> steps;
  };
  // Pieces of several nodes, which are at different pixels, take turns on a path.
  static constexpr std::size_t remembered = 64;

  // The steps of the place's pixel that end at or before its word.
  std::span<const LoggedStep> steps_to(walk::LogPlace place);
  void read(Pixel& pixel) const;
  [[nodiscard]] sim::Ticks traversal_of(std::uint32_t word) const;

  const program::WorkLog& log_;
  cost::StepTicks ticks_;
  std::vector<Pixel> pixels_;  // those asked for last
};

template <class Add>
void LogLevels::divide(walk::LogPlace place, sim::Ticks traversal, const Add& add) {
  const std::span<const LoggedStep> steps = steps_to(place);
  for (std::size_t step = steps.size(); step > 0 && traversal > 0;) {
    --step;
    add(steps[step].level, steps[step].traversal);
    traversal -= steps[step].traversal;
  }
  sim::ensure(traversal == 0, "the steps of a piece of a path do not add up to its length");
}

}  // namespace marti::processors::path
