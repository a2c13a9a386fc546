// The bounding volume hierarchy beside Embree's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "accel/bvh.h"
#include "scenes/procedural.h"
#include "tests/support/embree_bvh.h"

namespace marti::tests {
namespace {

class BesideEmbree : public ::testing::TestWithParam<const char*> {};

// Within 5 % of the cost of rtcBuildBVH's tree, or below it, by the same count of children and primitives.
TEST_P(BesideEmbree, TheTreeCostsNoMore) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(scenes::make_procedural(GetParam()));
  for (std::size_t at = 0; at < accel::bvh_node_names.size(); ++at) {
    const auto node = static_cast<accel::BvhNodeKind>(at);
    for (const std::uint32_t leaf : {1U, 3U, 8U}) {
      if (leaf > accel::bvh_largest_leaf(node)) {
        continue;
      }
      const accel::Bvh ours = accel::Bvh::build(triangles, {.node = node, .max_objects = leaf});
      const double theirs = embree_sah_cost(*triangles, accel::bvh_children(node), leaf);
      EXPECT_GT(theirs, 1.0);
      EXPECT_LE(ours.sah_cost(), 1.05 * theirs)
          << accel::bvh_node_names[at] << " children, " << leaf << " in a leaf";
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Bvh, BesideEmbree,
                         ::testing::Values("teapot:12", "gears:3", "tetra:5", "sombrero:3"),
                         [](const auto& tested) { return std::to_string(tested.index); });

}  // namespace
}  // namespace marti::tests
