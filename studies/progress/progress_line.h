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

namespace marti::studies::progress {

class ProgressLine {
 public:
  struct Options {
    std::FILE* out = stderr;                ///< the terminal
    std::chrono::milliseconds first{2000};  ///< what is done by then needs no line
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
