// How far a sweep has come, said on standard error: a bar on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

#include "studies/progress/progress_line.h"

namespace marti::studies::sweep {

/// Thread-safe.
class Progress {
 public:
  struct Options {
    bool terminal = false;  ///< a bar that is drawn over and over; else lines
    bool quiet = false;
    std::FILE* out = nullptr;
    unsigned workers = 1;                      ///< that share what is left
    std::chrono::milliseconds first_bar{200};  ///< a sweep that is done by then has no bar
  };
  explicit Progress(const Options& options) : options_(options) {}

  /// Machines and frames in all, and how many are done already.
  void begin(std::size_t machines, std::size_t machines_done, std::size_t frames, std::size_t frames_done);
  /// One more frame or machine is done. `nanoseconds_left`: processor time still to be spent; 0: not known.
  void traced(std::int64_t nanoseconds_left);
  void timed(std::int64_t nanoseconds_left);
  /// Takes the bar away.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string text(std::size_t width);
  void told(std::int64_t nanoseconds_left, bool last);
  /// Seconds of processor time that a second brings.
  [[nodiscard]] double processors() const;

  Options options_;
  std::mutex mutex_;  // of all below but the line
  std::size_t machines_ = 0;
  std::size_t machines_done_ = 0;
  std::size_t frames_ = 0;
  std::size_t frames_done_ = 0;
  Clock::time_point begun_;
  double processor_begun_ = 0.0;            // the processor time of this process then
  std::optional<progress::Duration> left_;  // estimated when the last frame or machine was done
  Clock::time_point told_;                  // when left_ was estimated
  Clock::time_point printed_;               // of the last line where there is no terminal
  std::optional<progress::ProgressLine> line_;
};

/// "350 of 1000 machines, 1 of 2 frames, 2 min 05 s left (4 min 10 s of processor time)", with a bar of
/// `width` characters before it, if that is not 0.
[[nodiscard]] std::string progress_text(std::size_t machines_done, std::size_t machines,
                                        std::size_t frames_done, std::size_t frames,
                                        const std::optional<progress::Duration>& left, std::size_t width);

}  // namespace marti::studies::sweep
