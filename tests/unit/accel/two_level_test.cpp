#include "accel/two_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "accel/brute_force.h"
#include "accel/counted.h"
#include "accel/structure.h"
#include "tests/support/same_bits.h"
#include "tests/support/user_error.h"

namespace marti::tests {
namespace {

using accel::BvhNodeKind;
using accel::TwoLevelBvh;
using scenes::InstancePlace;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  glm::dvec3 point(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  std::uint32_t below(std::size_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, static_cast<std::uint32_t>(n) - 1)(engine_);
  }

 private:
  std::mt19937_64 engine_;
};

/// Meshes of `size` whose instances stand in a cube of side 20, `offset` away from the origin.
scenes::Scene random_scene(std::uint64_t seed, double size, double offset = 0.0) {
  Random random(seed);
  scenes::Scene scene;
  scene.materials.resize(1);
  for (const std::uint32_t count : {1U, 2U, 40U, 300U}) {
    scene.meshes.push_back({static_cast<std::uint32_t>(scene.triangles.size()), count});
    const glm::dvec3 middle = random.point(3.0 * size);
    for (std::uint32_t i = 0; i < count; ++i) {
      const glm::dvec3 at = middle + random.point(size);
      const auto first = static_cast<std::uint32_t>(scene.positions.size());
      for (int k = 0; k < 3; ++k) {
        scene.positions.push_back(at + random.point(0.3 * size));
      }
      scene.triangles.push_back({{first, first + 1, first + 2}, 0, 0});
    }
  }
  for (int i = 0; i < 60; ++i) {
    InstancePlace place;
    place.mesh = random.below(scene.meshes.size());
    const glm::dquat turn = glm::normalize(
        glm::dquat(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)));
    place.linear = glm::mat3_cast(turn);
    for (int axis = 0; axis < 3; ++axis) {
      place.linear[axis] *= random.number(0.2, 2.0) / size * (random.below(4) == 0 ? -1.0 : 1.0);
    }
    place.shift = random.point(10.0) + glm::dvec3(offset);
    scene.instances.push_back(place);
    if (i % 10 == 0) {
      scene.instances.push_back(place);  // twice in one place: the first of equal hits counts
    }
  }
  scenes::number_instances(scene);
  return scene;
}

std::shared_ptr<const accel::TriangleSet> set_of_scene(const scenes::Scene& scene) {
  return std::make_shared<const accel::TriangleSet>(scene);
}

/// Every primitive of every instance, without a tree.
template <class Real>
accel::Hit naive_closest(const TwoLevelBvh& tree, const accel::Ray& ray) {
  const accel::RaySetup<Real> world(ray);
  accel::Best<Real> best(world);
  for (const accel::Instance& instance : tree.instances()) {
    const accel::RaySetup<Real> setup(instance.in_mesh<Real>(ray));
    best.first = instance.first();
    const accel::PrimitiveRange& mesh = tree.triangles().meshes()[instance.mesh()];
    for (std::uint32_t id = mesh.first; id < mesh.first + mesh.count; ++id) {
      accel::intersect_primitive(setup, tree.triangles(), id, best);
    }
  }
  return best.hit();
}

/// Towards a triangle of some instance.
accel::Ray random_ray(Random& random, const scenes::Scene& scene, double distance, double offset) {
  accel::Ray ray;
  ray.origin = random.point(distance) + glm::dvec3(offset);
  const InstancePlace& place = scene.instances[random.below(scene.instances.size())];
  const scenes::PrimitiveRange& mesh = scene.meshes[place.mesh];
  glm::dvec3 target(0.0);
  for (const std::uint32_t vertex : scene.triangles[mesh.first + random.below(mesh.count)].vertex) {
    target += place.of(scene.positions[vertex]) / 3.0;
  }
  ray.direction = target - ray.origin;
  if (random.below(16) == 0) {
    ray.direction[static_cast<int>(random.below(3))] = 0.0;
  }
  if (random.below(3) == 0) {
    ray.t_max = random.number(0.0, 1.5);
  }
  return ray;
}

/// Checks a walk: branches and instances that are children of those before, and leaves of the mesh that was
/// entered.
class StepCheck {
 public:
  explicit StepCheck(const TwoLevelBvh& tree) : tree_(tree), reached_(tree.topology().nodes.size()) {}
  void begin() { reached_.assign(reached_.size(), false), reached_[0] = true; }
  void branch(std::uint32_t node) {
    EXPECT_FALSE(tree_.topology().nodes.at(node).instance);
    enter(node);
    ++branches;
  }
  void transform(std::uint32_t node) {
    EXPECT_TRUE(tree_.topology().nodes.at(node).instance);
    enter(node);
    ++transforms;
  }
  void leaf(std::uint32_t node, std::uint32_t /*tests*/, std::uint32_t entries) {
    EXPECT_TRUE(tree_.topology().nodes.at(node).leaf);
    EXPECT_TRUE(reached_[node]);
    EXPECT_EQ(entries, tree_.topology().nodes[node].count);
  }
  void cut(std::uint32_t /*node*/) {}
  void pass(std::uint32_t /*record*/) {}

  std::uint64_t branches = 0;
  std::uint64_t transforms = 0;

 private:
  void enter(std::uint32_t node) {
    const accel::TopologyNode& branch = tree_.topology().nodes.at(node);
    EXPECT_FALSE(branch.leaf);
    EXPECT_TRUE(reached_[node]);
    for (std::uint32_t child = branch.first; child < branch.first + branch.count; ++child) {
      reached_.at(child) = true;
    }
  }

  const TwoLevelBvh& tree_;
  std::vector<bool> reached_;
};

class InstancesOfEachNode : public ::testing::TestWithParam<BvhNodeKind> {
 protected:
  [[nodiscard]] static TwoLevelBvh build(const scenes::Scene& scene) {
    return TwoLevelBvh::build(set_of_scene(scene), {.node = GetParam(), .threads = 1});
  }
};

INSTANTIATE_TEST_SUITE_P(TwoLevels, InstancesOfEachNode,
                         ::testing::Values(BvhNodeKind::two, BvhNodeKind::four, BvhNodeKind::six,
                                           BvhNodeKind::eight, BvhNodeKind::eight_quantised));

TEST_P(InstancesOfEachNode, HitsAreThoseOfEveryPrimitiveOfEveryInstance) {
  std::uint64_t hits = 0;
  for (const double size : {1.0, 1e-6, 1e5}) {
    for (const double offset : {0.0, 1e7}) {
      const scenes::Scene scene = random_scene(7, size, offset);
      const TwoLevelBvh tree = build(scene);
      StepCheck steps(tree);
      accel::NullVisitor nobody;
      Random random(11);
      for (int i = 0; i < 120; ++i) {
        // From inside, from near, from so far that the slow walk is taken.
        const double distance = std::vector<double>{10.0, 100.0, 1e5}[random.below(3)];
        const accel::Ray ray = random_ray(random, scene, distance, offset);
        const accel::Hit expected = naive_closest<double>(tree, ray);
        steps.begin();
        const accel::Hit found = tree.closest(ray, steps);
        EXPECT_TRUE(test::same_bits(found, expected));
        EXPECT_EQ(tree.occluded(ray, nobody), expected.found());
        EXPECT_TRUE(test::same_bits(tree.closest<accel::Counted>(ray, nobody), expected));
        EXPECT_TRUE(test::same_bits(tree.closest<float>(ray, nobody), naive_closest<float>(tree, ray)));
        hits += expected.found() ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hits, 200U);
}

/// How many instances have boxes that the ray meets, each made larger by `margin` on each side.
std::uint64_t boxes_met(const TwoLevelBvh& tree, const accel::Ray& ray, double margin) {
  std::uint64_t met = 0;
  for (const accel::Instance& instance : tree.instances()) {
    double in = 0.0;
    double out = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = (instance.box().lo[axis] - margin - ray.origin[axis]) / ray.direction[axis];
      const double hi = (instance.box().hi[axis] + margin - ray.origin[axis]) / ray.direction[axis];
      in = std::max(in, std::min(lo, hi));
      out = std::min(out, std::max(lo, hi));
    }
    met += in <= out ? 1 : 0;
  }
  return met;
}

// A ray that hits nothing is brought into each instance whose box it meets, once. Boxes are kept a little
// larger: of floats, by 2^-18 of the scene; of bytes, by a 255th of a node, which is no more than the scene.
TEST_P(InstancesOfEachNode, ARayIsBroughtIntoTheInstancesThatItMeets) {
  const scenes::Scene scene = random_scene(13, 0.5);
  const TwoLevelBvh tree = build(scene);
  const bool bytes = GetParam() == BvhNodeKind::six || GetParam() == BvhNodeKind::eight_quantised;
  StepCheck steps(tree);
  Random random(3);
  std::uint64_t misses = 0;
  std::uint64_t sure = 0;
  for (int i = 0; i < 2000; ++i) {
    accel::Ray ray;
    ray.origin = random.point(20.0);
    ray.direction = random.point(1.0);
    steps.begin();
    steps.transforms = 0;
    if (!tree.closest(ray, steps).found()) {
      const std::uint64_t least = boxes_met(tree, ray, 0.0);
      const std::uint64_t most = boxes_met(tree, ray, bytes ? 0.2 : 0.001);
      EXPECT_GE(steps.transforms, least);
      EXPECT_LE(steps.transforms, most);
      ++misses;
      sure += least > 0 && least == most ? 1 : 0;
    }
  }
  EXPECT_GT(misses, 200U);
  EXPECT_GT(sure, 50U);
}

/// Some instances and half of the largest mesh are elsewhere.
scenes::Scene moved_scene(scenes::Scene scene, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = 0; i < scene.instances.size(); i += 3) {
    scene.instances[i].shift += random.point(5.0);
  }
  const scenes::PrimitiveRange& mesh = scene.meshes.back();
  for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count / 2; ++t) {
    for (const std::uint32_t vertex : scene.triangles[t].vertex) {
      scene.positions[vertex] += random.point(1.0);
    }
  }
  scenes::number_instances(scene);
  return scene;
}

TEST_P(InstancesOfEachNode, MovedTreesHitWhatTreesBuiltFromNothingDo) {
  scenes::Scene scene = random_scene(7, 1.0);
  TwoLevelBvh rebuilt = build(scene);
  TwoLevelBvh refitted = build(scene);
  const accel::Topology first = refitted.topology();
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    scene = moved_scene(scene, frame);
    const TwoLevelBvh fresh = build(scene);
    rebuilt = rebuilt.moved(set_of_scene(scene), TwoLevelBvh::Update::rebuild);
    refitted = refitted.moved(set_of_scene(scene), TwoLevelBvh::Update::refit);
    EXPECT_TRUE(rebuilt.topology() == fresh.topology());
    EXPECT_TRUE(refitted.topology() == first);
    StepCheck steps_of_fresh(fresh);
    StepCheck steps_of_rebuilt(rebuilt);
    StepCheck steps_of_refitted(refitted);
    Random random(frame);
    for (int i = 0; i < 200; ++i) {
      const accel::Ray ray = random_ray(random, scene, 20.0, 0.0);
      for (StepCheck* const steps : {&steps_of_fresh, &steps_of_rebuilt, &steps_of_refitted}) {
        steps->begin();
      }
      const accel::Hit expected = fresh.closest(ray, steps_of_fresh);
      EXPECT_TRUE(test::same_bits(rebuilt.closest(ray, steps_of_rebuilt), expected));
      EXPECT_TRUE(test::same_bits(refitted.closest(ray, steps_of_refitted), expected));
      EXPECT_TRUE(test::same_bits(naive_closest<double>(refitted, ray), expected));
    }
    EXPECT_EQ(steps_of_rebuilt.branches, steps_of_fresh.branches);
    EXPECT_GT(steps_of_refitted.branches, steps_of_fresh.branches);
  }
  scene.instances.front().mesh = 1;
  scenes::number_instances(scene);
  EXPECT_NE(test::user_error_of([&] {
              static_cast<void>(refitted.moved(set_of_scene(scene), TwoLevelBvh::Update::refit));
            }).find("other meshes or instances"),
            std::string::npos);
}

TEST_P(InstancesOfEachNode, HitsAreThoseOfCopiesUpToRounding) {
  const scenes::Scene scene = random_scene(3, 0.5);
  const TwoLevelBvh tree = build(scene);
  const accel::BruteForce copied(set_of_scene(scenes::copied_instances(scene)));
  accel::NullVisitor nobody;
  Random random(5);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const accel::Ray ray = random_ray(random, scene, 30.0, 0.0);
    const accel::Hit expected = copied.closest(ray, nobody);
    const accel::Hit found = tree.closest(ray, nobody);
    ASSERT_EQ(found.found(), expected.found());
    if (found.found()) {
      ++hits;
      // A thousandth of a billionth of the way; the stretch of these instances is below 64.
      EXPECT_NEAR(found.t, expected.t, 1e-12);
      EXPECT_EQ(found.primitive, expected.primitive);
      // Of a mirrored copy two corners change places.
      EXPECT_NEAR(found.u, expected.u, 1e-9);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST_P(InstancesOfEachNode, TheTopologyIsOneTreeForEachMeshBelowItsInstances) {
  const scenes::Scene scene = random_scene(9, 1.0);
  const TwoLevelBvh tree = build(scene);
  const std::vector<accel::TopologyNode>& nodes = tree.topology().nodes;
  EXPECT_EQ(tree.topology().entries.size(), scene.triangles.size());
  std::vector<std::uint32_t> parents(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (!nodes[n].leaf) {
      for (std::uint32_t child = nodes[n].first; child < nodes[n].first + nodes[n].count; ++child) {
        ASSERT_GT(child, n);
        ASSERT_GT(nodes.at(child).level, nodes[n].level);
        ++parents[child];
      }
    }
  }
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count_if(nodes, &accel::TopologyNode::instance)),
            scene.instances.size());
  std::uint32_t roots_of_meshes = 0;
  std::uint32_t instances = 0;
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    ASSERT_GE(parents[n], 1U);
    roots_of_meshes += parents[n] > 1 ? 1 : 0;
    instances += parents[n] > 1 ? parents[n] : 0;
  }
  EXPECT_EQ(roots_of_meshes, 4U);
  EXPECT_EQ(instances, scene.instances.size());
}

TEST(TwoLevelBvh, TransformsThatItCannotTurnBackAreRefused) {
  const auto refused = [](const glm::dmat3& linear, const glm::dvec3& shift) {
    return test::user_error_of([&] {
      scenes::Scene scene = random_scene(1, 1.0);
      scene.instances = {{0, linear, shift}};
      scenes::number_instances(scene);
      static_cast<void>(TwoLevelBvh::build(set_of_scene(scene), {.threads = 1}));
    });
  };
  const double infinity = std::numeric_limits<double>::infinity();
  glm::dmat3 flat(1.0);
  flat[2] = flat[1];
  EXPECT_NE(refused(flat, {}).find("singular"), std::string::npos);
  EXPECT_NE(refused(glm::dmat3(0.0), {}).find("singular"), std::string::npos);
  EXPECT_NE(refused(glm::dmat3(1e-19), {}).find("singular"), std::string::npos);
  EXPECT_NE(refused(glm::dmat3(1e19), {}).find("2^60"), std::string::npos);
  EXPECT_NE(refused(glm::dmat3(1.0), {infinity, 0.0, 0.0}).find("2^300"), std::string::npos);
  flat[2] = flat[1] + glm::dvec3(0.0, 0.0, 1e-4);
  EXPECT_NE(refused(flat, {}).find("stretches"), std::string::npos);
  EXPECT_EQ(refused(glm::dmat3(1.0), {}), "no UserError");
}

TEST(TwoLevelBvh, OtherStructuresRefuseInstances) {
  for (const std::string_view kind : accel::structure_kinds()) {
    const std::string error = test::user_error_of(
        [&] { static_cast<void>(accel::make_structure(kind, set_of_scene(random_scene(1, 1.0)))); });
    EXPECT_EQ(error.find("only a bvh") != std::string::npos, kind != "bvh") << kind << ": " << error;
  }
}

TEST(TwoLevelBvh, TenMillionTrianglesOfInstancesTakeLittleMemory) {
  scenes::Scene scene = random_scene(2, 0.1);
  const std::uint32_t count = scene.meshes.back().count;
  scene.instances.clear();
  Random random(4);
  for (std::uint32_t i = 0; i * count < 10'000'000; ++i) {
    scene.instances.push_back({3, glm::dmat3(1.0), random.point(50.0)});
  }
  scenes::number_instances(scene);
  const TwoLevelBvh tree = TwoLevelBvh::build(set_of_scene(scene));
  EXPECT_GE(tree.instances().back().first() + scene.meshes[3].first + count, 10'000'000U);
  EXPECT_LT(tree.walk_bytes() + bytes_of(tree.topology()), 30'000'000U);
}

}  // namespace
}  // namespace marti::tests
