#include "studies/progress/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim/cpu_time.h"
#include "studies/tables/text_units.h"

namespace marti::studies::progress {

namespace {

// So many characters leave the line one line.
std::size_t columns_of(std::FILE* out) {
  winsize size{};
  const bool known = ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col - 1U : 79U;
}

}  // namespace

ProgressLine::ProgressLine(const Options& options, std::function<std::string()> text)
    : options_(options), text_(std::move(text)), thread_([this] {
        std::unique_lock lock(mutex_);
        auto pause = options_.first;
        while (!changed_.wait_for(lock, pause, [this] { return ended_; })) {
          draw();
          pause = options_.between;
        }
      }) {}

ProgressLine::~ProgressLine() {
  end();
  thread_.join();
}

void ProgressLine::draw() {
  std::string text = text_();
  text.resize(std::min(text.size(), columns_of(options_.out)));
  if (text.empty()) {
    return;
  }
  // Blanks cover the rest of a longer line.
  const std::size_t blank = drawn_ > text.size() ? drawn_ - text.size() : 0;
  std::fprintf(options_.out, "\r%s%s", text.c_str(), std::string(blank, ' ').c_str());
  std::fflush(options_.out);
  drawn_ = text.size();
}

void ProgressLine::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
  if (drawn_ != 0) {
    std::fprintf(options_.out, "\r%s\r", std::string(drawn_, ' ').c_str());
    std::fflush(options_.out);
    drawn_ = 0;
  }
}

bool errors_go_to_a_terminal() { return isatty(STDERR_FILENO) == 1; }

std::string progress_bar(std::uint64_t done, std::uint64_t of, std::size_t width) {
  if (width == 0) {
    return "";
  }
  const std::size_t full = of == 0 ? width : static_cast<std::size_t>(width * std::min(done, of) / of);
  return "[" + std::string(full, '#') + std::string(width - full, '.') + "] ";
}

ShownMeter::ShownMeter(const sim::WorkMeter& meter, const Foreseen* foreseen) {
  if (errors_go_to_a_terminal()) {
    const auto text = [&meter, foreseen, pace = Pace(), estimate = WholeEstimate(),
                       begin = std::chrono::steady_clock::now()]() mutable {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
      const sim::WorkMeter::State state = meter.state();
      return meter_text(
          state, passed.count(), pace.left(state, {passed.count(), sim::process_cpu_seconds()}),
          foreseen == nullptr ? 0.0 : estimate.seconds(state, foreseen->parts(), passed.count()));
    };
    line_.emplace(ProgressLine::Options(), text);
    at_signal_.emplace([this](int /*signal*/) { line_->end(); }, host::AtSignal::Then::signal);
  }
}

std::string left_text(const Duration& left) {
  return left.seconds < 1.0
             ? std::string()
             : fmt::format(", {} left ({} of processor time)", tables::duration_text(left.seconds),
                           tables::duration_text(left.processor));
}

Duration Pace::left(const sim::WorkMeter::State& state, const Duration& now) {
  if (state.part != part_ || state.done < done_) {
    part_ = state.part;
    done_ = state.done;
    first_ = now;
  }
  if (state.done == done_ || state.of <= state.done) {
    return {};
  }
  const double times = static_cast<double>(state.of - state.done) / static_cast<double>(state.done - done_);
  return {times * (now.seconds - first_.seconds), times * (now.processor - first_.processor)};
}

std::string meter_text(const sim::WorkMeter::State& state, double seconds, const Duration& left,
                       double whole) {
  if (state.part.empty()) {
    return "";
  }
  const std::string passed =
      tables::duration_text(seconds) + (whole > 0.0 ? " of about " + tables::duration_text(whole) : "");
  if (state.whole_of != 0) {
    return progress_bar(state.whole_done, state.whole_of, usual_bar) +
           fmt::format("{} of {} {}, {}{}: {}", state.whole_done, state.whole_of, state.whole_unit, passed,
                       left_text(state.left), state.part);
  }
  if (state.of == 0) {
    return fmt::format("{}, {}", state.part, passed);
  }
  const std::uint64_t done = std::min(state.done, state.of);
  return progress_bar(done, state.of, usual_bar) + fmt::format("{}: {} of {} {}, {}{}", state.part, done,
                                                               state.of, state.unit, passed,
                                                               whole > 0.0 ? std::string() : left_text(left));
}

}  // namespace marti::studies::progress
