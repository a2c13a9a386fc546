#include "processors/flow/pixel_trees.h"

#include "sim/error.h"

namespace marti::processors::flow {

std::uint32_t PixelTrees::open(const SentSample& sample) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(trees_.size()));
    trees_.emplace_back();
  }
  const std::uint32_t tree = free_.back();
  free_.pop_back();
  program::rays_of_sample(sample.words, trees_[tree].rays);
  sim::ensure(!trees_[tree].rays.empty(), "a sample's words belong to no ray");
  trees_[tree].place = sample.place;
  trees_[tree].alive = 1;
  return tree;
}

void PixelTrees::end_ray(std::uint32_t tree) {
  if (--trees_[tree].alive == 0) {
    free_.push_back(tree);
  }
}

}  // namespace marti::processors::flow
