#include "processors/path/log_levels.h"

#include <algorithm>
#include <span>

namespace marti::processors::path {

std::uint32_t LogLevels::level_at(walk::LogPlace place) {
  const std::span<const LoggedStep> steps = steps_to(place);
  return steps.empty() ? 0 : steps.back().level;
}

std::span<const LogLevels::LoggedStep> LogLevels::steps_to(walk::LogPlace place) {
  if (place.pixel == walk::LogPlace::nowhere) {
    return {};
  }
  constexpr std::uint32_t golden = 2654435769U;  // Fibonacci hashing: Knuth, TAOCP 3, section 6.4
  Pixel& pixel = pixels_[(place.pixel * golden >> 16U) % remembered];
  if (pixel.number != place.pixel) {
    pixel.number = place.pixel;
    read(pixel);
  }
  const auto end =
      std::upper_bound(pixel.steps.begin(), pixel.steps.end(), place.word,
                       [](std::uint32_t word, const LoggedStep& step) { return word < step.end; });
  return {pixel.steps.begin(), end};
}

void LogLevels::read(Pixel& pixel) const {
  pixel.steps.clear();
  const std::span<const std::uint32_t> words =
      log_.pixel(pixel.number % log_.width, pixel.number / log_.width);
  for (std::size_t at = 0; at < words.size();) {
    const std::uint32_t word = words[at];
    at += program::step_words(&words[at]);
    const std::uint32_t level = program::visits_node(program::step_of(word))
                                    ? log_.topology.nodes[program::operand_of(word)].level
                                    : 0;
    pixel.steps.push_back({static_cast<std::uint32_t>(at), level, traversal_of(word)});
  }
}

sim::Ticks LogLevels::traversal_of(std::uint32_t word) const {
  switch (program::step_of(word)) {
    case program::Step::branch:
      return ticks_.branch;
    case program::Step::leaf:
    case program::Step::partial_leaf:
    case program::Step::mailed_leaf:
      return ticks_.leaf;
    case program::Step::ray:
      return ticks_.ray[program::ray_number_of(program::operand_of(word))];
    case program::Step::transform:
      return ticks_.transform;
    case program::Step::cut:
      return ticks_.cut;
    case program::Step::pass:
      return ticks_.pass;
    default:
      return 0;
  }
}

}  // namespace marti::processors::path
