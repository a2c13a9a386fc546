#include "studies/sweep/work/progress.h"

#include <fmt/format.h>

#include <algorithm>

#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

constexpr std::chrono::milliseconds between_bars(200);
constexpr std::chrono::seconds between_lines(10);
constexpr std::size_t bar_width = 24;

}  // namespace

std::string progress_text(std::size_t machines_done, std::size_t machines, std::size_t frames_done,
                          std::size_t frames, std::optional<double> seconds_left, std::size_t width) {
  std::string text;
  if (width != 0) {
    const std::size_t full = machines == 0 ? width : width * machines_done / machines;
    text = "[" + std::string(full, '#') + std::string(width - full, '.') + "] ";
  }
  text += fmt::format("{} of {} machines, {} of {} frames", machines_done, machines, frames_done, frames);
  if (seconds_left) {
    text += ", " + duration_text(*seconds_left) + " left";
  }
  return text;
}

void Progress::begin(std::size_t machines, std::size_t machines_done, std::size_t frames,
                     std::size_t frames_done) {
  machines_ = machines;
  machines_done_ = machines_done;
  frames_ = frames;
  frames_done_ = frames_done;
  shown_ = Clock::now();
}

void Progress::traced(std::int64_t nanoseconds_left) {
  ++frames_done_;
  show(nanoseconds_left, false);
}

void Progress::timed(std::int64_t nanoseconds_left) {
  ++machines_done_;
  show(nanoseconds_left, machines_done_ == machines_);
}

void Progress::show(std::int64_t nanoseconds_left, bool always) {
  if (options_.quiet) {
    return;
  }
  const Clock::time_point now = Clock::now();
  if (!always && shown_ &&
      now - *shown_ < (options_.terminal ? Clock::duration(between_bars) : between_lines)) {
    return;
  }
  shown_ = now;
  // The time left is not known before the first machine is done, nor when all that are left are under way.
  const std::optional<double> left =
      nanoseconds_left == 0 ? std::nullopt
                            : std::optional(static_cast<double>(nanoseconds_left) * 1e-9 / options_.workers);
  const std::string text = progress_text(machines_done_, machines_, frames_done_, frames_, left,
                                         options_.terminal ? bar_width : 0);
  if (options_.terminal) {
    // Blanks cover the rest of a longer bar.
    const std::size_t blank = drawn_ > text.size() ? drawn_ - text.size() : 0;
    std::fprintf(options_.out, "\r%s%s", text.c_str(), std::string(blank, ' ').c_str());
    drawn_ = text.size();
  } else {
    std::fprintf(options_.out, "%s\n", text.c_str());
  }
  std::fflush(options_.out);
}

void Progress::end() {
  if (drawn_ != 0) {
    std::fprintf(options_.out, "\r%s\r", std::string(drawn_, ' ').c_str());
    std::fflush(options_.out);
    drawn_ = 0;
  }
}

}  // namespace marti::studies
