#include "studies/progress/whole_estimate.h"

#include <algorithm>
#include <iterator>

namespace marti::studies::progress {

namespace {

// Parts of this many seconds together say as much about how fast this computer is as what was foreseen does.
constexpr double trusted = 1.0;
// A part that took longer says more about itself than about others.
constexpr double most_correction = 2.0;
// A part that takes longer than foreseen goes on for this much of what it took.
constexpr double overrun = 0.15;

// What was foreseen is off by this factor, by parts that took so long.
double correction(double took, double foreseen) {
  return std::clamp((trusted + took) / (trusted + foreseen), 1.0 / most_correction, most_correction);
}

}  // namespace

// The parts up to `part` are over; those that were never seen took no time.
void WholeEstimate::finish_parts_before(std::size_t part, double passed) {
  took_ += passed - begun_;
  for (; part_ < std::min(part, parts_.size()); ++part_) {
    foreseen_ += parts_[part_].seconds;
  }
  part_ = part;
  begun_ = passed;
}

double WholeEstimate::seconds(const sim::WorkMeter::State& state, const std::vector<ForeseenPart>& parts,
                              double passed) {
  const auto found = std::ranges::find_if(
      parts, [&](const ForeseenPart& part) { return state.part.starts_with(part.name); });
  if (found == parts.end()) {
    return 0.0;
  }
  const auto part = static_cast<std::size_t>(std::distance(parts.begin(), found));
  if (part > part_) {
    finish_parts_before(part, passed);
  }
  parts_ = parts;
  const double taken = passed - begun_;
  const double foreseen = found->seconds * correction(took_, foreseen_) - taken;
  double left = std::max(foreseen, overrun * taken);
  if (found->counted && state.of != 0 && state.done != 0) {
    const double done = static_cast<double>(std::min(state.done, state.of)) / static_cast<double>(state.of);
    const double by_pace = taken * (1.0 - done) / done;
    left = done * by_pace + (1.0 - done) * std::max(foreseen, 0.0);
  }
  const double of_later = correction(took_ + taken + left, foreseen_ + found->seconds);
  for (auto later = std::next(found); later != parts.end(); ++later) {
    left += later->seconds * of_later;
  }
  return passed + left;
}

}  // namespace marti::studies::progress
