// How far a sweep has come, said on standard error: a bar on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

namespace marti::studies {

/// Called by one thread at a time.
class Progress {
 public:
  struct Options {
    bool terminal = false;  ///< a bar that is drawn over and over; else lines
    bool quiet = false;
    std::FILE* out = nullptr;
    unsigned workers = 1;  ///< that share what is left
  };
  explicit Progress(const Options& options) : options_(options) {}

  /// Machines and frames in all, and how many are done already.
  void begin(std::size_t machines, std::size_t machines_done, std::size_t frames, std::size_t frames_done);
  /// One more frame or machine is done. `nanoseconds_left`: processor time still to be spent.
  void traced(std::int64_t nanoseconds_left);
  void timed(std::int64_t nanoseconds_left);
  /// Takes the bar away.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::int64_t nanoseconds_left, bool always);

  Options options_;
  std::size_t machines_ = 0;
  std::size_t machines_done_ = 0;
  std::size_t frames_ = 0;
  std::size_t frames_done_ = 0;
  std::optional<Clock::time_point> shown_;
  std::size_t drawn_ = 0;  // characters of the bar
};

/// "350 of 1000 machines, 1 of 2 frames, 2 min 05 s left", with a bar of `width` characters before it, if
/// that is not 0.
[[nodiscard]] std::string progress_text(std::size_t machines_done, std::size_t machines,
                                        std::size_t frames_done, std::size_t frames,
                                        std::optional<double> seconds_left, std::size_t width);

}  // namespace marti::studies
