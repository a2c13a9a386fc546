#include "processors/program/ray_tree.h"

namespace marti::processors::program {

namespace {

// The number of the ray that made ray `child`; `none` for a pixel's first ray.
std::uint32_t parent_of(const std::vector<LoggedRay>& rays, std::uint32_t child) {
  for (std::uint32_t at = child; at-- > 0;) {
    if (rays[at].kind != RayKind::shadow && rays[at].bounce < rays[child].bounce) {
      return at;
    }
  }
  return child == 0 ? LoggedRay::none : 0;
}

}  // namespace

std::span<const std::uint32_t> first_sample(const WorkLog& log, std::span<const std::uint32_t> words) {
  if (log.samples == 1 || words.empty()) {
    return words;
  }
  const std::uint32_t* const end = words.data() + words.size();
  const std::uint32_t* word = words.data() + step_words(words.data());
  while (word != end && *word != camera_ray) {
    word += step_words(word);
  }
  return words.first(static_cast<std::size_t>(word - words.data()));
}

void rays_of_sample(std::span<const std::uint32_t> words, std::vector<LoggedRay>& rays) {
  rays.clear();
  const std::uint32_t* const end = words.data() + words.size();
  for (const std::uint32_t* word = words.data(); word != end; word += step_words(word)) {
    while (whole_visit(*word)) {
      if (++word == end) {
        break;
      }
    }
    if (word == end) {
      break;
    }
    if (step_of(*word) == Step::ray) {
      LoggedRay ray;
      ray.begin = rays.empty() ? words.data() : word;
      ray.kind = ray_kind_of(operand_of(*word));
      ray.bounce = bounce_of(operand_of(*word));
      if (!rays.empty()) {
        rays.back().end = word;
      }
      rays.push_back(ray);
    }
  }
  if (!rays.empty()) {
    rays.back().end = end;
  }
  // From the last ray to the first, so that each list of children comes out in the order of the log.
  for (auto child = static_cast<std::uint32_t>(rays.size()); child-- > 1;) {
    LoggedRay& ray = rays[child];
    ray.parent = parent_of(rays, child);
    ray.next_sibling = rays[ray.parent].first_child;
    rays[ray.parent].first_child = child;
  }
}

}  // namespace marti::processors::program
