// How far the work of one command is, on the terminal.
#pragma once

#include <optional>
#include <string>

#include "sim/work_meter.h"
#include "studies/host/signals_held.h"
#include "studies/progress/progress_line.h"

namespace marti::studies::progress {

/// Shows the meter while it lives, if standard error is a terminal and the work takes more than two seconds.
/// `meter` must outlive it.
class ShownMeter {
 public:
  explicit ShownMeter(const sim::WorkMeter& meter);

 private:
  std::optional<ProgressLine> line_;
  std::optional<host::AtSignal> at_signal_;  // takes the line away
};

/// "[######......] tracing: 120 of 240 rows, 5.0 s": what is done, and how long the work has taken. Without
/// steps that are counted there is no bar; empty before anything was begun.
[[nodiscard]] std::string meter_text(const sim::WorkMeter::State& state, double seconds);

}  // namespace marti::studies::progress
