// The rays of a pixel: the words of each ray, and its parent.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>
#include <span>

#include "processors/program/log_rules.h"
#include "processors/program/ray_tree.h"
#include "tests/support/logged_samples.h"
#include "tests/support/random_flow.h"

namespace marti::processors {

using namespace program;

namespace {

using test::ray_word;

std::vector<std::uint32_t> children_of(const std::vector<LoggedRay>& rays, std::uint32_t ray) {
  std::vector<std::uint32_t> children;
  for (std::uint32_t child = rays[ray].first_child; child != LoggedRay::none;
       child = rays[child].next_sibling) {
    children.push_back(child);
  }
  return children;
}

TEST(RayTree, FollowsTheRecursionOfTheTracer) {
  // A camera ray with two lights, a mirror seen in a mirror, and a refraction of the first point.
  const std::vector<std::uint32_t> words = {
      ray_word(RayKind::camera, 0),     make_word(Step::branch, 0), make_word(Step::shade, 0),
      ray_word(RayKind::shadow, 1),     make_word(Step::light, 0),  ray_word(RayKind::shadow, 1),
      ray_word(RayKind::reflection, 1), make_word(Step::shade, 1),  ray_word(RayKind::shadow, 2),
      ray_word(RayKind::reflection, 2), make_word(Step::branch, 0), ray_word(RayKind::refraction, 1),
      make_word(Step::branch, 0)};
  std::vector<LoggedRay> rays;
  rays_of_sample(words, rays);
  ASSERT_EQ(rays.size(), 7U);
  EXPECT_EQ(children_of(rays, 0), (std::vector<std::uint32_t>{1, 2, 3, 6}));
  EXPECT_EQ(children_of(rays, 3), (std::vector<std::uint32_t>{4, 5}));
  EXPECT_EQ(rays[5].kind, RayKind::reflection);
  EXPECT_EQ(rays[5].bounce, 2U);
  EXPECT_EQ(rays[1].end - rays[1].begin, 2);
}

TEST(RayTree, OfAPixelWithoutRaysIsEmpty) {
  std::vector<LoggedRay> rays(3);
  rays_of_sample({}, rays);
  EXPECT_TRUE(rays.empty());
}

RC_GTEST_PROP(RayTree, EveryWordIsOneRaysAndEveryRayHasOneParent, ()) {
  test::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const WorkLog log = test::random_log(random, 3, 2);
  std::vector<LoggedRay> rays;
  for (std::uint32_t x = 0; x < 3; ++x) {
    const auto words = log.pixel(x, 1);
    rays_of_sample(words, rays);
    RC_ASSERT(!rays.empty());
    const std::uint32_t* at = words.data();
    std::vector<int> parents(rays.size());
    for (std::uint32_t ray = 0; ray < rays.size(); ++ray) {
      RC_ASSERT(rays[ray].begin == at);
      at = rays[ray].end;
      for (const std::uint32_t child : children_of(rays, ray)) {
        RC_ASSERT(child > ray);
        RC_ASSERT(rays[child].parent == ray);
        ++parents[child];
      }
    }
    RC_ASSERT(at == words.data() + words.size());
    RC_ASSERT(parents[0] == 0);
    RC_ASSERT(std::accumulate(parents.begin(), parents.end(), 0) == static_cast<int>(rays.size()) - 1);
    RC_ASSERT(std::all_of(parents.begin() + 1, parents.end(), [](int n) { return n == 1; }));
  }
}

RC_GTEST_PROP(RayTree, SamplesAreAPixelsWordsFromCameraRayToCameraRay, ()) {
  test::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const auto samples = static_cast<std::uint32_t>(test::pick(random, 1, 6));
  WorkLog log = test::random_ray_trees(random, 4, 2, 6, 3, samples);
  log.lights = 1;
  RC_ASSERT(program::fault_of(log) == "");
  for (std::uint32_t x = 0; x < 4; ++x) {
    std::span<const std::uint32_t> left = log.pixel(x, 1);
    for (const auto& expected : test::samples_of_pixel(log, x, 1)) {
      const auto sample = first_sample(log, left);
      RC_ASSERT(sample.data() == expected.data());
      RC_ASSERT(sample.size() == expected.size());
      left = left.subspan(sample.size());
    }
    RC_ASSERT(left.empty());
  }
  RC_ASSERT(first_sample(log, {}).empty());
}

}  // namespace
}  // namespace marti::processors
