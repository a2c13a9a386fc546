// How far work has come, said on a terminal: a line that is drawn over and over.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "sim/work_meter.h"
#include "studies/host/signals_held.h"
#include "studies/progress/whole_estimate.h"

namespace marti::studies::progress {

class ProgressLine {
 public:
  struct Options {
    std::FILE* out = stderr;               ///< the terminal
    std::chrono::milliseconds first{200};  ///< what is done by then needs no line
    std::chrono::milliseconds between{200};
  };

  /// `text` is called by a thread of this object; an empty one is not drawn.
  ProgressLine(const Options& options, std::function<std::string()> text);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Takes the line away; nothing is drawn after that. From any thread, but not from `text`; may be repeated.
  void end();

 private:
  void draw();

  Options options_;
  std::function<std::string()> text_;
  std::mutex mutex_;  // of all below, held while `text` is called
  std::condition_variable changed_;
  bool ended_ = false;
  std::size_t drawn_ = 0;  // characters on the terminal
  std::thread thread_;
};

/// Whether standard error is a terminal.
[[nodiscard]] bool errors_go_to_a_terminal();

/// "[####....] ", with `width` characters between the brackets; empty for a width of 0.
[[nodiscard]] std::string progress_bar(std::uint64_t done, std::uint64_t of, std::size_t width);

/// The width of bars on terminals.
inline constexpr std::size_t usual_bar = 24;

/// Shows the meter while it lives, if standard error is a terminal and the work takes more than a fifth of a
/// second. `meter` and `foreseen`, which may be null, must outlive it.
class ShownMeter {
 public:
  explicit ShownMeter(const sim::WorkMeter& meter, const Foreseen* foreseen = nullptr);

 private:
  std::optional<ProgressLine> line_;
  std::optional<host::AtSignal> at_signal_;  // takes the line away
};

using sim::Duration;

/// ", 2 min 05 s left (4 min 10 s of processor time)"; empty below a second: an estimate that comes to its
/// end says nothing.
[[nodiscard]] std::string left_text(const Duration& left);

/// Says how long the part of a meter takes yet: its steps left take as long as those that it has seen done.
class Pace {
 public:
  /// What is left, `now` after any begin; nothing before a step of the part was seen done.
  [[nodiscard]] Duration left(const sim::WorkMeter::State& state, const Duration& now);

 private:
  std::string part_;
  std::uint64_t done_ = 0;  // when the part was seen first
  Duration first_;          // when that was
};

/// "[######......] tracing: 120 of 240 rows, 5.0 s, 15 s left (30 s of processor time)": what is done, how
/// long the whole work has taken, and what is left of this part; "5.0 s of about 40 s" where the seconds of
/// the `whole` work are known. Without steps that are counted there is no
/// bar; empty before anything was begun. Of work that is planned as a whole, "[######......] 12 of 40
/// parts, 5.0 s, 15 s left (30 s of processor time): tracing": all parts, and what is left of them.
[[nodiscard]] std::string meter_text(const sim::WorkMeter::State& state, double seconds,
                                     const Duration& left = {}, double whole = 0.0);

}  // namespace marti::studies::progress
