// The trees of rays of the samples that are being traced. They are made and freed sample by sample, because
// the trees of a whole frame would be larger than its log.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/flow/flow_host.h"
#include "processors/program/ray_tree.h"

namespace marti::processors::flow {

class PixelTrees {
 public:
  /// Makes the tree of a sample with at least one ray. Its camera ray is ray 0 and is counted as alive.
  std::uint32_t open(const SentSample& sample);

  [[nodiscard]] const program::LoggedRay& ray(std::uint32_t tree, std::uint32_t number) const {
    return trees_[tree].rays[number];
  }
  [[nodiscard]] walk::PixelPlace place(std::uint32_t tree) const { return trees_[tree].place; }
  /// Counts one more live ray of the tree.
  void begin_ray(std::uint32_t tree) { ++trees_[tree].alive; }
  /// Ends a ray whose children have been counted; the tree is freed when no ray is alive.
  void end_ray(std::uint32_t tree);

 private:
  struct Tree {
    std::vector<program::LoggedRay> rays;
    walk::PixelPlace place;
    std::uint32_t alive = 0;
  };
  std::vector<Tree> trees_;
  std::vector<std::uint32_t> free_;
};

}  // namespace marti::processors::flow
