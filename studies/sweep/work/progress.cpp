#include "studies/sweep/work/progress.h"

#include <fmt/format.h>

#include "studies/tables/text_units.h"

namespace marti::studies::sweep {

namespace {

constexpr std::chrono::seconds between_lines(10);

}  // namespace

std::string progress_text(std::size_t machines_done, std::size_t machines, std::size_t frames_done,
                          std::size_t frames, std::optional<double> seconds_left, std::size_t width) {
  std::string text = progress::progress_bar(machines_done, machines, width);
  text += fmt::format("{} of {} machines, {} of {} frames", machines_done, machines, frames_done, frames);
  if (seconds_left && *seconds_left >= 1.0) {
    text += ", " + tables::duration_text(*seconds_left) + " left";
  }
  return text;
}

void Progress::begin(std::size_t machines, std::size_t machines_done, std::size_t frames,
                     std::size_t frames_done) {
  {
    const std::lock_guard lock(mutex_);
    machines_ = machines;
    machines_done_ = machines_done;
    frames_ = frames;
    frames_done_ = frames_done;
    told_ = printed_ = Clock::now();
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
  seconds_left_ = nanoseconds_left == 0
                      ? std::nullopt
                      : std::optional(static_cast<double>(nanoseconds_left) * 1e-9 / options_.workers);
  if (!options_.quiet && !options_.terminal && (last || told_ - printed_ >= between_lines)) {
    printed_ = told_;
    std::fprintf(options_.out, "%s\n",
                 progress_text(machines_done_, machines_, frames_done_, frames_, seconds_left_, 0).c_str());
    std::fflush(options_.out);
  }
}

// Between two machines time passes, too.
std::string Progress::text(std::size_t width) {
  const std::lock_guard lock(mutex_);
  const std::chrono::duration<double> passed = Clock::now() - told_;
  const std::optional<double> left =
      seconds_left_ ? std::optional(*seconds_left_ - passed.count()) : std::nullopt;
  return progress_text(machines_done_, machines_, frames_done_, frames_, left, width);
}

void Progress::end() {
  if (line_) {
    line_->end();
  }
}

}  // namespace marti::studies::sweep
