// The trees of rays of the samples that are being traced: a pool, because a frame's trees would be larger
// than its log.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/flow/flow_host.h"
#include "processors/program/ray_tree.h"

namespace marti::processors {

class PixelTrees {
 public:
  /// The tree of a sample with at least one ray; its camera ray is ray 0 and is alive.
  std::uint32_t open(const SentSample& sample);

  [[nodiscard]] const LoggedRay& ray(std::uint32_t tree, std::uint32_t number) const {
    return trees_[tree].rays[number];
  }
  [[nodiscard]] PixelPlace place(std::uint32_t tree) const { return trees_[tree].place; }
  /// A ray of the tree comes alive.
  void begin_ray(std::uint32_t tree) { ++trees_[tree].alive; }
  /// A ray has ended and its children have come alive; without any alive the tree is forgotten.
  void end_ray(std::uint32_t tree);

 private:
  struct Tree {
    std::vector<LoggedRay> rays;
    PixelPlace place;
    std::uint32_t alive = 0;
  };
  std::vector<Tree> trees_;
  std::vector<std::uint32_t> free_;
};

}  // namespace marti::processors
