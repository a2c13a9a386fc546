// The kernels in floats: every structure finds the hits of brute force in floats too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "accel/structure.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/support/same_bits.h"

namespace marti::tests {
namespace {

using accel::Hit;
using accel::Ray;
using accel::TriangleSet;

/// Whether the direction is in the range of normal floats.
bool fits(const Ray& ray) {
  const double size =
      std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
  return size >= 0x1p-126 && size <= 0x1p127;
}

std::vector<std::unique_ptr<accel::Structure>> all_kinds(
    const std::shared_ptr<const TriangleSet>& triangles) {
  std::vector<std::unique_ptr<accel::Structure>> all;
  for (const std::string_view kind : accel::structure_kinds()) {
    all.push_back(accel::make_structure(kind, triangles));
  }
  accel::StructureOptions pushed;
  pushed.bsp.walk = accel::BspWalk::push_point;
  all.push_back(accel::make_structure("bsp", triangles, pushed));
  for (std::size_t node = 0; node < accel::bvh_node_names.size(); ++node) {
    accel::StructureOptions options;
    options.bvh.node = static_cast<accel::BvhNodeKind>(node);
    all.push_back(accel::make_structure("bvh", triangles, options));
  }
  return all;
}

void compare(std::vector<accel::TriangleCorners> corners, std::uint64_t seed,
             const std::vector<scenes::Quadric>& quadrics = {}) {
  const auto triangles = std::make_shared<const TriangleSet>(std::move(corners), quadrics);
  const accel::BruteForce oracle(triangles);
  const auto all = all_kinds(triangles);
  RayMaker maker(*triangles, all[0]->bounds(), seed);
  accel::NullVisitor visitor;
  std::uint64_t hits = 0;
  for (const Aim aim : tests::all_aims) {
    for (int k = 0; k < 30; ++k) {
      const Ray ray = maker.make(aim);
      if (!fits(ray)) {
        continue;
      }
      const Hit expected = oracle.closest<float>(ray, visitor);
      hits += expected.found() ? 1U : 0U;
      for (const auto& structure : all) {
        accel::visit_structure(*structure, [&](const auto& concrete) {
          ASSERT_TRUE(test::same_bits(expected, concrete.template closest<float>(ray, visitor)))
              << structure->kind();
          ASSERT_EQ(expected.found(), concrete.template occluded<float>(ray, visitor));
        });
      }
    }
  }
  EXPECT_GT(hits, 50U);
}

TEST(FloatKernel, EveryStructureGivesBruteForcesHits) {
  for (const double offset : {0.0, 1e4}) {
    compare(tests::hostile_soup(offset, 11), 12);
  }
  compare(tests::hostile_soup(0.0, 13, true), 14);
}

TEST(FloatKernel, CurvedPrimitivesToo) {
  scenes::Quadric ball;
  ball.kind = scenes::QuadricKind::sphere;
  ball.radius = 0.6;
  scenes::Quadric cone;
  cone.kind = scenes::QuadricKind::cone;
  cone.base = {-0.5, -0.5, -0.5};
  cone.tip = {0.7, 0.6, 0.5};
  cone.radius = 0.3;
  cone.tip_radius = 0.1;
  compare(tests::hostile_soup(0.0, 15), 16, {ball, cone});
}

TEST(FloatKernel, RefusesDirectionsThatAreNoFloats) {
  const auto triangles = std::make_shared<const TriangleSet>(tests::hostile_soup(0.0, 1));
  const accel::BruteForce brute(triangles);
  accel::NullVisitor visitor;
  Ray ray;
  ray.direction = {0.0, 1e-60, 0.0};
  EXPECT_NO_THROW(static_cast<void>(brute.closest(ray, visitor)));
  EXPECT_THROW(static_cast<void>(brute.closest<float>(ray, visitor)), sim::InternalError);
  ray.direction = {0.0, 1e60, 0.0};
  EXPECT_NO_THROW(static_cast<void>(brute.closest(ray, visitor)));
  EXPECT_THROW(static_cast<void>(brute.closest<float>(ray, visitor)), sim::InternalError);
}

}  // namespace
}  // namespace marti::tests
