#include "studies/sweep/work/progress.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/cpu_time.h"

namespace marti::studies::sweep {

namespace {

constexpr std::chrono::seconds between_lines(10);

}  // namespace

std::string progress_text(std::size_t machines_done, std::size_t machines, std::size_t frames_done,
                          std::size_t frames, const std::optional<progress::Duration>& left,
                          std::size_t width) {
  std::string text = progress::progress_bar(machines_done, machines, width);
  text += fmt::format("{} of {} machines, {} of {} frames", machines_done, machines, frames_done, frames);
  return left ? text + progress::left_text(*left) : text;
}

void Progress::begin(std::size_t machines, std::size_t machines_done, std::size_t frames,
                     std::size_t frames_done) {
  {
    const std::lock_guard lock(mutex_);
    machines_ = machines;
    machines_done_ = machines_done;
    frames_ = frames;
    frames_done_ = frames_done;
    begun_ = told_ = printed_ = Clock::now();
    processor_begun_ = sim::process_cpu_seconds();
  }
  if (options_.terminal && !options_.quiet) {
    line_.emplace(progress::ProgressLine::Options{.out = options_.out, .first = options_.first_bar},
                  [this] { return text(progress::usual_bar); });
  }
}

void Progress::traced(std::int64_t nanoseconds_left) {
  const std::lock_guard lock(mutex_);
  ++frames_done_;
  told(nanoseconds_left, false);
}

void Progress::timed(std::int64_t nanoseconds_left) {
  const std::lock_guard lock(mutex_);
  ++machines_done_;
  told(nanoseconds_left, machines_done_ == machines_);
}

void Progress::told(std::int64_t nanoseconds_left, bool last) {
  told_ = Clock::now();
  left_.reset();
  if (nanoseconds_left != 0) {
    const double processor = static_cast<double>(nanoseconds_left) * 1e-9;
    left_ = progress::Duration{processor / processors(), processor};
  }
  if (!options_.quiet && !options_.terminal && (last || told_ - printed_ >= between_lines)) {
    printed_ = told_;
    std::fprintf(options_.out, "%s\n",
                 progress_text(machines_done_, machines_, frames_done_, frames_, left_, 0).c_str());
    std::fflush(options_.out);
  }
}

// Between two machines time passes, too.
std::string Progress::text(std::size_t width) {
  const std::lock_guard lock(mutex_);
  const std::chrono::duration<double> passed = Clock::now() - told_;
  std::optional<progress::Duration> left = left_;
  if (left) {
    left->seconds -= passed.count();
    left->processor = std::max(0.0, left->processor - passed.count() * processors());
  }
  return progress_text(machines_done_, machines_, frames_done_, frames_, left, width);
}

// Beside other programs threads get less than a processor each: as much as until now.
double Progress::processors() const {
  constexpr double shortest = 0.2;  // what a shorter time says is chance
  const std::chrono::duration<double> passed = Clock::now() - begun_;
  return passed.count() < shortest
             ? options_.workers
             : std::clamp((sim::process_cpu_seconds() - processor_begun_) / passed.count(), 0.01,
                          1.0 * options_.workers);
}

void Progress::end() {
  if (line_) {
    line_->end();
  }
}

}  // namespace marti::studies::sweep
