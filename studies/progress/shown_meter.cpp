#include "studies/progress/shown_meter.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "studies/tables/text_units.h"

namespace marti::studies::progress {

ShownMeter::ShownMeter(const sim::WorkMeter& meter) {
  if (errors_go_to_a_terminal()) {
    line_.emplace(ProgressLine::Options(), [&meter, begin = std::chrono::steady_clock::now()] {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
      return meter_text(meter.state(), passed.count());
    });
    at_signal_.emplace([this](int /*signal*/) { line_->end(); }, host::AtSignal::Then::signal);
  }
}

std::string meter_text(const sim::WorkMeter::State& state, double seconds) {
  if (state.part.empty()) {
    return "";
  }
  const std::string passed = tables::duration_text(seconds);
  if (state.of == 0) {
    return fmt::format("{}, {}", state.part, passed);
  }
  const std::uint64_t done = std::min(state.done, state.of);
  return progress_bar(done, state.of, usual_bar) +
         fmt::format("{}: {} of {} {}, {}", state.part, done, state.of, state.unit, passed);
}

}  // namespace marti::studies::progress
