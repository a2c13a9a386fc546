// The scenes of spheres, cylinders and cones, and the ones composed: counts by closed form, sizes as V.
// Havran published them, and what their recipes imply.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "scenes/open.h"
#include "scenes/procedural.h"
#include "sim/error.h"

namespace marti::scenes {
namespace {

struct Counts {
  std::uint64_t polygons = 0;
  std::uint64_t triangles = 0;
  std::uint64_t spheres = 0;
  std::uint64_t cylinders = 0;
  std::uint64_t cones = 0;
};

void expect(const std::string& spec, const Counts& counts) {
  const Scene scene = make_procedural(spec);
  const SceneFacts facts = facts_of(scene);
  EXPECT_EQ(facts.polygons, counts.polygons) << spec;
  EXPECT_EQ(facts.triangles, counts.triangles) << spec;
  EXPECT_EQ(facts.spheres, counts.spheres) << spec;
  EXPECT_EQ(facts.cylinders, counts.cylinders) << spec;
  EXPECT_EQ(facts.cones, counts.cones) << spec;
  EXPECT_EQ(facts.degenerate_triangles, 0U) << spec;
  EXPECT_EQ(facts.duplicate_triangles, 0U) << spec;
  EXPECT_FALSE(scene.lights.empty()) << spec;
  EXPECT_NO_THROW(static_cast<void>(scene.camera.image_plane(2, 2))) << spec;
  for (std::size_t i = 0; i < scene.quadrics.size(); ++i) {
    EXPECT_NO_THROW(check_quadric(scene.quadrics[i], spec));
    EXPECT_LT(scene.quadrics[i].material, scene.materials.size());
    EXPECT_EQ(scene.quadrics[i].source, i);
  }
  for (const Triangle& triangle : scene.triangles) {
    EXPECT_LT(triangle.material, scene.materials.size());
    EXPECT_LT(triangle.polygon, scene.polygons);
  }
}

TEST(CurvedScenes, CountsFollowTheClosedForms) {
  std::uint64_t power9 = 1;
  std::uint64_t power8 = 8;
  std::uint64_t power4 = 4;
  std::uint64_t power2 = 2;
  for (std::uint64_t n = 1; n <= 4; ++n) {
    power9 *= 9;
    const std::string size = ":" + std::to_string(n);
    expect("balls" + size, {1, 2, (9 * power9 - 1) / 8, 0, 0});
    expect("jacks" + size, {0, 0, 6 * (power8 - 1) / 7, 3 * (power8 - 1) / 7, 0});
    expect("lattice" + size, {0, 0, (n + 1) * (n + 1) * (n + 1), 3 * n * (n + 1) * (n + 1), 0});
    expect("mount" + size, {2 * power4, 2 * power4, 4, 0, 0});
    expect("rings" + size, {1, 2, 5 * n * (n + 1) * (2 * n + 1), 5 * n * (n + 1) * (2 * n + 1), 0});
    expect("shells" + size, {0, 0, 180 * power2 + 1, 0, 0});
    const std::uint64_t side = 16 * power2 - 1;
    expect("sombrero" + size, {2 * side * side, 2 * side * side, 0, 0, 0});
    expect("tree" + size, {1, 2, 2 * power2 - 1, 0, 2 * power2 - 1});
    power8 *= 8;
    power4 *= 4;
    power2 *= 2;
  }
  expect("balls:0", {1, 2, 1, 0, 0});
  expect("tree:0", {1, 2, 1, 0, 1});
  expect("balls", {1, 2, 7381, 0, 0});
  // A gear's two faces of 144 corners give 142 triangles each, its 144 sides two each.
  expect("large", {19409, 2 * 9120 + 8 * (2 * 142 + 2 * 144) + 2, 0, 0, 0});
}

void expect_size(const std::string& spec, const glm::dvec3& size, double tolerance) {
  const Bounds bounds = bounds_of(make_procedural(spec));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(bounds.hi[axis] - bounds.lo[axis], size[axis], tolerance) << spec << " axis " << axis;
  }
}

// V. Havran, Heuristic Ray Shooting Algorithms, 2000, and his statistics of the SPD: sizes of the scenes'
// boxes, to the digits printed.
TEST(CurvedScenes, BoundingSizesAreThePublishedOnes) {
  expect_size("balls", {24.0, 24.0, 1.3306}, 6e-5);
  expect_size("lattice", glm::dvec3(1.04167), 6e-6);
  expect_size("mount", {2.1596, 2.1596, 2.0812}, 6e-5);
  expect_size("rings", {19.678, 19.251, 19.678}, 6e-4);
  expect_size("tree", {100.0, 100.0, 3.137}, 6e-4);
}

// Each ball rests on its parent: centres are as far apart as both radii.
TEST(CurvedScenes, BallsTouchTheirParents) {
  const Scene scene = make_procedural("balls:3");
  std::vector<const Quadric*> path;  // a ball comes right after its parent or its elder sibling's last
  for (const Quadric& ball : scene.quadrics) {
    while (!path.empty() && path.back()->radius <= ball.radius) {
      path.pop_back();
    }
    if (!path.empty()) {
      EXPECT_NEAR(glm::length(ball.base - path.back()->base), ball.radius + path.back()->radius, 1e-12);
      EXPECT_NEAR(ball.radius * 3.0, path.back()->radius, 1e-15);
    }
    path.push_back(&ball);
  }
}

// The rings are linked: the middles of their rods come as near as 0.1389 to each other (so that the rods, of
// radius 0.0741, graze) and no nearer.
TEST(CurvedScenes, RingsAreLinkedAndApart) {
  const Scene scene = make_procedural("rings:1");
  const auto ring_of = [](std::size_t i) { return i / 10; };
  const auto distance = [](const Quadric& a, const Quadric& b) {
    double least = 1e9;  // sampled
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        const glm::dvec3 p = a.base + (i / 40.0) * (a.tip - a.base);
        const glm::dvec3 q = b.base + (j / 40.0) * (b.tip - b.base);
        least = std::min(least, glm::length(p - q));
      }
    }
    return least;
  };
  double nearest = 1e9;
  for (std::size_t i = 0; i < scene.quadrics.size(); i += 2) {
    ASSERT_EQ(scene.quadrics[i].kind, QuadricKind::cylinder);
    ASSERT_EQ(scene.quadrics[i + 1].kind, QuadricKind::sphere);
    EXPECT_EQ(scene.quadrics[i].base, scene.quadrics[i + 1].base);
    for (std::size_t j = 0; j < scene.quadrics.size(); j += 2) {
      if (ring_of(i) != ring_of(j)) {
        nearest = std::min(nearest, distance(scene.quadrics[i], scene.quadrics[j]));
      }
    }
  }
  EXPECT_NEAR(nearest, 0.1389, 5e-5);
}

// Each branch begins at its parent's tip with its parent's radius there.
TEST(CurvedScenes, TreeIsConnected) {
  const Scene scene = make_procedural("tree:6");
  for (std::size_t i = 0; i < scene.quadrics.size(); i += 2) {
    const Quadric& branch = scene.quadrics[i];
    const Quadric& knot = scene.quadrics[i + 1];
    ASSERT_EQ(branch.kind, QuadricKind::cone);
    EXPECT_EQ(branch.tip, knot.base);
    EXPECT_EQ(branch.tip_radius, knot.radius);
    if (i == 0) {
      EXPECT_EQ(branch.base, glm::dvec3(0.0));
      continue;
    }
    bool grows = false;
    for (std::size_t j = 0; j < i; j += 2) {
      grows = grows || (scene.quadrics[j].tip == branch.base &&
                        std::abs(scene.quadrics[j].tip_radius - branch.radius) < 1e-15);
    }
    EXPECT_TRUE(grows) << i;
  }
}

// Neighbouring cells of the mountain share their vertices: an inner edge belongs to two triangles.
TEST(CurvedScenes, MountainHasNoCracks) {
  const Scene scene = make_procedural("mount:5");
  EXPECT_EQ(scene.positions.size(), 33U * 33U);
}

TEST(CurvedScenes, LargeIsMadeOfItsParts) {
  const Scene scene = make_procedural("large");
  EXPECT_EQ(scene.name, "large");
  EXPECT_EQ(scene.polygons, 2U * 9120U + 1169U);
  EXPECT_EQ(scene.normals.size(), scene.positions.size());
  const Bounds bounds = bounds_of(scene);
  EXPECT_EQ(bounds.lo, glm::dvec3(-2.0, -2.0, 0.0)) << "everything stands on the ground";
  EXPECT_EQ(glm::dvec2(bounds.hi), glm::dvec2(2.0, 2.0));
  EXPECT_THROW(static_cast<void>(make_procedural("large:2")), sim::UserError);
}

TEST(CurvedScenes, AreDescribed) {
  const std::string text = describe(make_procedural("lattice:2"));
  EXPECT_NE(text.find("spheres: 27\n"), std::string::npos) << text;
  EXPECT_NE(text.find("cylinders: 54\n"), std::string::npos) << text;
  EXPECT_NE(text.find("cones: 0\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("bounds: none"), std::string::npos) << text;
}

}  // namespace
}  // namespace marti::scenes
