#include "processors/path/log_levels.h"

#include <algorithm>
#include <span>

namespace marti::processors {

std::uint32_t LogLevels::level_at(LogPlace place) {
  if (place.pixel == LogPlace::nowhere) {
    return 0;
  }
  const std::size_t steps = read(place);
  return steps == 0 ? 0 : steps_[steps - 1].level;
}

std::size_t LogLevels::read(LogPlace place) {
  if (place.pixel != pixel_) {
    pixel_ = place.pixel;
    steps_.clear();
    const std::span<const std::uint32_t> words = log_.pixel(pixel_ % log_.width, pixel_ / log_.width);
    for (std::size_t at = 0; at < words.size();) {
      const std::uint32_t word = words[at];
      at += step_words(&words[at]);
      const std::uint32_t level =
          visits_node(step_of(word)) ? log_.topology.nodes[operand_of(word)].level : 0;
      steps_.push_back({static_cast<std::uint32_t>(at), level, traversal_of(word)});
    }
  }
  const auto end =
      std::upper_bound(steps_.begin(), steps_.end(), place.word,
                       [](std::uint32_t word, const LoggedStep& step) { return word < step.end; });
  return static_cast<std::size_t>(end - steps_.begin());
}

sim::Ticks LogLevels::traversal_of(std::uint32_t word) const {
  switch (step_of(word)) {
    case Step::branch:
      return ticks_.branch;
    case Step::leaf:
    case Step::partial_leaf:
    case Step::mailed_leaf:
      return ticks_.leaf;
    case Step::ray:
      return ticks_.ray[operand_of(word) & 3U];
    case Step::cut:
      return ticks_.cut;
    case Step::pass:
      return ticks_.pass;
    default:
      return 0;
  }
}

}  // namespace marti::processors
