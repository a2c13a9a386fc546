// Rays that leave a surface: they must not meet it again. tests/stability has closed meshes at every scale
// and far from the origin.
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "processors/program/shading.h"
#include "program_scenes.h"
#include "tests/support/icosphere.h"
#include "tests/support/long_tests.h"

namespace marti::processors {

using namespace program;

namespace {

/// A unit sphere, wound counter-clockwise seen from outside.
scenes::Scene icosphere() {
  const tests::Icosphere sphere(3);
  scenes::Scene scene;
  scene.materials.emplace_back();
  scene.positions = sphere.vertices;
  for (std::array<std::uint32_t, 3> face : sphere.faces) {
    const glm::dvec3& a = sphere.vertices[face[0]];
    const glm::dvec3& b = sphere.vertices[face[1]];
    const glm::dvec3& c = sphere.vertices[face[2]];
    if (glm::dot(glm::cross(b - a, c - a), a) < 0.0) {
      std::swap(face[1], face[2]);
    }
    scene.triangles.push_back({face, 0, static_cast<std::uint32_t>(scene.polygons++)});
  }
  return scene;
}

// A checkerboard in the plane `axis` = height, whose triangles have no error in that coordinate when the
// height is 0: rays that leave it on either side must not meet it again.
TEST(LeavingAPlane, NoRayMeetsTheBoardItLeft) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const double height : {0.0, 1.0, -1e-9, 1e6}) {
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      scenes::Scene scene;
      scene.materials.emplace_back();
      const auto point = [&](int i, int j) {
        glm::dvec3 p(height);
        p[(axis + 1) % 3] = -4.0 + 8.0 * i / 12.0;
        p[(axis + 2) % 3] = -4.0 + 8.0 * j / 12.0;
        return p;
      };
      for (std::uint32_t k = 0; k < 144; ++k) {
        const int i = static_cast<int>(k / 12);
        const int j = static_cast<int>(k % 12);
        for (const glm::dvec3& p : {point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)}) {
          scene.positions.push_back(p);
        }
        scene.triangles.push_back({{4 * k, 4 * k + 1, 4 * k + 2}, 0, k});
        scene.triangles.push_back({{4 * k + 2, 4 * k + 3, 4 * k}, 0, k});
      }
      const test::Built built(scene, "octree");
      for (int ray = 0; ray < marti::test::cases(5000); ++ray) {
        glm::dvec3 eye(unit(random) * 9.0, unit(random) * 9.0, unit(random) * 9.0);
        eye[axis] = height + (ray % 2 == 0 ? 5.4 : -5.4);
        glm::dvec3 aim(unit(random) * 3.9, unit(random) * 3.9, unit(random) * 3.9);
        aim[axis] = height;
        const glm::dvec3 d = glm::normalize(aim - eye);
        const accel::Hit hit = built.structure->closest({eye, d});
        ASSERT_TRUE(hit.found());
        const double weights[3] = {hit.u, hit.v, hit.w};
        const Surface<double> surface = surface_at(built.scene, hit.primitive, weights, Vec3<double>(d), 8.0);
        glm::dvec3 out(unit(random), unit(random), unit(random));
        const Vec3<double> from = leave(surface, Vec3<double>(out));
        ASSERT_FALSE(built.structure->occluded({{from.x, from.y, from.z}, out}))
            << height << " axis " << axis;
      }
    }
  }
}

// Leaving rays in floats, whose kernel may err by more than the margin: how rare that is, and that the
// spacing of floats decides it.
TEST(Leaving, InFloatsHardlyAnyRayMeetsTheSurfaceThatItLeaves) {
  const test::Built built(icosphere(), "octree");
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  };
  int left = 0;
  int met = 0;
  int passed = 0;
  accel::visit_structure(*built.structure, [&](const auto& concrete) {
    accel::NullVisitor visitor;
    for (int i = 0; i < marti::test::cases(20000); ++i) {
      const glm::dvec3 eye = direction() * 4.0;
      const glm::dvec3 d = glm::normalize(direction() * 0.5 - eye);
      const accel::Hit hit = concrete.template closest<float>({eye, d}, visitor);
      ASSERT_TRUE(hit.found());
      const float weights[3] = {static_cast<float>(hit.u), static_cast<float>(hit.v),
                                static_cast<float>(hit.w)};
      const Surface<float> surface = surface_at(built.scene, hit.primitive, weights, Vec3<float>(d), 2.0);
      Vec3<float> out(direction());
      const float cosine = dot(out, surface.geometric);
      if (std::abs(cosine) < 0.01F) {
        continue;
      }
      out = cosine < 0.0F ? -out : out;
      const auto is_hit = [&](const Vec3<float>& to) {
        const Vec3<float> from = leave(surface, to);
        accel::Ray ray{{from.x, from.y, from.z}, {to.x, to.y, to.z}};
        ray.t_min = static_cast<double>(std::numeric_limits<float>::denorm_min());
        return concrete.template occluded<float>(ray, visitor);
      };
      met += is_hit(out) ? 1 : 0;
      passed += is_hit(-out) ? 0 : 1;
      ++left;
    }
  });
  EXPECT_GT(left, marti::test::cases(19000));
  EXPECT_LT(met, left / 1000);
  EXPECT_EQ(passed, 0);
}

TEST(Leaving, NextTowardIsTheNeighbour) {
  for (const double value : {1.0, -1.0, 0.0, -0.0, 1e-310, -3.5e200}) {
    EXPECT_EQ(next_toward(value, 2.0), std::nextafter(value, std::numeric_limits<double>::infinity()));
    EXPECT_EQ(next_toward(value, -2.0), std::nextafter(value, -std::numeric_limits<double>::infinity()));
    EXPECT_EQ(next_toward(value, 0.0), value);
  }
  for (const float value : {1.0F, -1.0F, 0.0F, 1e-40F, -3.5e20F}) {
    EXPECT_EQ(next_toward(value, 2.0F), std::nextafter(value, std::numeric_limits<float>::infinity()));
    EXPECT_EQ(next_toward(value, -2.0F), std::nextafter(value, -std::numeric_limits<float>::infinity()));
  }
}

// Triangles in a coordinate plane have points without rounding error and so without offset.
TEST(Leaving, PlanesThroughTheOriginDoNotShadowThemselves) {
  scenes::Scene scene = test::looking_down(10.0);
  scene.materials.emplace_back();
  test::add_floor(scene, 0.0, 100.0, 0);
  scene.lights.emplace_back();
  scene.lights[0].position = {3.0, 2.0, 50.0};
  for (const char* kind : {"none", "octree"}) {
    const Frame frame = test::Built(scene, kind).render({.width = 64, .height = 64, .max_depth = 1});
    EXPECT_EQ(frame.rays.traced[1], 4096U);
    EXPECT_EQ(frame.rays.hit[1], 0U);
  }
}

}  // namespace
}  // namespace marti::processors
