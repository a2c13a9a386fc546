#include "accel/brute_force.h"

#include <numeric>
#include <utility>

namespace marti::accel {

BruteForce::BruteForce(std::shared_ptr<const TriangleSet> triangles) : triangles_(std::move(triangles)) {
  const std::uint32_t n = triangles_->size();
  topology_.nodes.push_back({0, n, 1, true});
  topology_.entries.resize(n);
  std::iota(topology_.entries.begin(), topology_.entries.end(), 0U);
}

}  // namespace marti::accel
