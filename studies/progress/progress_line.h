// A line on a terminal that is drawn over and over while something long is done, and taken away at the end.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

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

}  // namespace marti::studies::progress
