// Given rays hit in every structure what a test of all primitives finds, and what Embree finds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>

#include "accel/brute_force.h"
#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/given_rays.h"
#include "scenes/procedural.h"
#include "tests/support/files.h"
#include "tests/support/ray_file.h"
#include "tests/support/same_bits.h"
#include "tests/support/temporary_directory.h"
#ifdef MARTI_EMBREE
#include "tests/support/embree_rays.h"
#endif

namespace marti::tests {
namespace {

using processors::program::Frame;
using processors::program::GivenHit;
using processors::program::Integrator;
using processors::program::RenderOptions;

using Random = std::mt19937_64;

double between(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

/// A number that a float holds as well.
double narrow(double number) { return static_cast<double>(static_cast<float>(number)); }

glm::dvec3 any_point(Random& random, double reach) {
  return {narrow(between(random, -reach, reach)), narrow(between(random, -reach, reach)),
          narrow(between(random, -reach, reach))};
}

/// Triangles and spheres of all sizes within a cube of 2.
scenes::Scene random_scene(Random& random, std::uint32_t triangles, std::uint32_t spheres) {
  scenes::Scene scene;
  scene.materials.resize(1);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::dvec3 at = any_point(random, 1.0);
    const double size = std::pow(10.0, between(random, -1.5, 0.2));
    for (int corner = 0; corner < 3; ++corner) {
      const glm::dvec3 p = at + any_point(random, size);
      scene.positions.emplace_back(narrow(p.x), narrow(p.y), narrow(p.z));
    }
    scene.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, 0, i});
  }
  for (std::uint32_t i = 0; i < spheres; ++i) {
    scenes::Quadric sphere;
    sphere.kind = scenes::QuadricKind::sphere;
    sphere.base = any_point(random, 1.0);
    sphere.radius = std::pow(10.0, between(random, -2.0, -0.5));
    scene.quadrics.push_back(sphere);
  }
  return scene;
}

/// `count` rays from a file, of both kinds if `kinds`: long and short ones, from within the scene and from
/// outside, some along an axis, the lengths of their directions up to so many orders of magnitude from 1.
scenes::GivenRays random_rays(Random& random, std::uint32_t count, bool floats, bool kinds, double reach,
                              double magnitudes) {
  std::vector<double> numbers;
  for (std::uint32_t ray = 0; ray < count; ++ray) {
    const glm::dvec3 from = any_point(random, reach);
    glm::dvec3 along = any_point(random, 1.0);
    if (ray % 16 == 0) {
      along = {0.0, 0.0, 0.0};
      along[static_cast<glm::length_t>(random() % 3)] = random() % 2 == 0 ? 1.0 : -1.0;
    }
    const double least = ray % 3 == 0 ? between(random, 0.0, 0.5) : 0.0;
    const double greatest =
        ray % 2 == 0 ? std::numeric_limits<double>::infinity() : least + between(random, 0.0, reach);
    const double length = ray % 5 == 0 ? std::pow(10.0, between(random, -magnitudes, magnitudes)) : 1.0;
    along *= length;
    numbers.insert(numbers.end(),
                   {from.x, from.y, from.z, least / length, along.x, along.y, along.z, greatest / length});
    if (kinds) {
      numbers.push_back(ray % 4 < 2 ? 0.0 : 1.0);
    }
  }
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "rays.npy";
  const std::size_t columns = kinds ? 9 : 8;
  test::write(file, floats ? test::ray_file<float>(numbers, columns) : test::ray_file(numbers, columns));
  return scenes::read_rays(file, {});
}

accel::Ray ray_of(const scenes::GivenRay& given) {
  return {given.origin, given.direction, given.least, given.greatest};
}

/// The frame of all rays in rows of `width`.
Frame traced(const scenes::Scene& scene, const std::shared_ptr<const accel::TriangleSet>& primitives,
             const accel::Structure& structure, std::uint32_t width) {
  RenderOptions options;
  options.integrator = Integrator::rays;
  options.width = width;
  options.height = (static_cast<std::uint32_t>(scene.rays.rays.size()) + width - 1) / width;
  options.record = true;
  options.hits = true;
  return processors::program::render(scene, *primitives, structure, options, 2);
}

TEST(GivenRays, HitWhatBruteForceHits) {
  Random random(4);
  std::uint64_t found = 0;
  std::uint64_t blocked = 0;
  for (int round = 0; round < 12; ++round) {
    scenes::Scene scene = random_scene(random, 20U << (round % 5), round % 2 == 0 ? 0 : 10);
    scene.rays = random_rays(random, 1000, round % 4 < 2, round % 3 != 0, 1.5, 20.0);
    const auto primitives = std::make_shared<const accel::TriangleSet>(scene);
    const auto brute = accel::make_structure("none", primitives);
    for (const std::string_view kind : accel::structure_kinds()) {
      const auto structure = accel::make_structure(kind, primitives);
      const Frame frame = traced(scene, primitives, *structure, 64);
      for (std::size_t i = 0; i < scene.rays.rays.size(); ++i) {
        const accel::Ray ray = ray_of(scene.rays.rays[i]);
        const GivenHit& hit = frame.hits[i];
        if (scene.rays.wants_any(i)) {
          EXPECT_EQ(hit.any, brute->occluded(ray)) << kind << ", ray " << i;
          blocked += hit.any ? 1 : 0;
        } else {
          const accel::Hit expected = brute->closest(ray);
          EXPECT_TRUE(test::same_bits(expected, hit.hit)) << kind << ", ray " << i;
          EXPECT_EQ(hit.any, expected.found());
          found += hit.any ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(found, 5'000U);
  EXPECT_GT(blocked, 2'000U);
}

// A ray's words are itself and its visits; the pixels behind the last ray have none.
TEST(GivenRays, AreAllThatTheLogHas) {
  Random random(5);
  scenes::Scene scene = random_scene(random, 100, 0);
  scene.rays = random_rays(random, 1000, false, true, 2.0, 0.0);
  const auto primitives = std::make_shared<const accel::TriangleSet>(scene);
  const auto structure = accel::make_structure("bvh", primitives);
  const Frame frame = traced(scene, primitives, *structure, 64);
  EXPECT_EQ(frame.rays.traced[0], 500U);
  EXPECT_EQ(frame.rays.traced[1], 500U);
  const processors::program::LogTotals totals = processors::program::totals_of(*frame.log);
  EXPECT_EQ(totals.all_rays(), 1000U);
  EXPECT_EQ(totals.all_steps(), totals.all_rays() + totals.branches + totals.leaves + totals.tests);
  for (std::uint32_t pixel = 0; pixel < 64 * 16; ++pixel) {
    EXPECT_EQ(frame.log->pixel(pixel % 64, pixel / 64).empty(), pixel >= 1000);
  }
  // Rows of another length have the same rays in the same order.
  const Frame other = traced(scene, primitives, *structure, 50);
  for (std::uint32_t ray = 0; ray < 1000; ++ray) {
    const auto one = frame.log->pixel(ray % 64, ray / 64);
    const auto two = other.log->pixel(ray % 50, ray / 50);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), two.begin(), two.end()));
  }
}

// A frame with fewer pixels, by which memory is estimated, has rays from all of the file.
TEST(GivenRays, AreSpreadOverSmallFrames) {
  RenderOptions options;
  options.width = 7;
  options.height = 3;
  std::uint64_t last = 0;
  for (std::uint32_t pixel = 1; pixel < 21; ++pixel) {
    const std::uint64_t ray = given_ray(options, 1000, pixel % 7, pixel / 7);
    EXPECT_TRUE(ray == last + 47 || ray == last + 48) << ray;
    last = ray;
  }
  EXPECT_EQ(last, 952U);
  EXPECT_EQ(given_ray(options, 20, 6, 2), 20U);
  EXPECT_EQ(given_ray(options, 21, 6, 2), 20U);
}

#ifdef MARTI_EMBREE
// Embree computes in floats, so near edges and between surfaces that lie close together it may see others.
TEST(GivenRays, HitWhatEmbreeHits) {
  Random random(6);
  scenes::Scene scene = scenes::make_procedural("teapot:12:pot");
  for (glm::dvec3& p : scene.positions) {
    p = {narrow(p.x), narrow(p.y), narrow(p.z)};
  }
  scene.rays = random_rays(random, 200'000, true, true, 3.0, 3.0);
  const auto primitives = std::make_shared<const accel::TriangleSet>(scene);
  const Frame frame = traced(scene, primitives, *accel::make_structure("bvh", primitives), 500);
  const std::vector<accel::Hit> theirs = embree_hits(scene);
  std::uint64_t found = 0;
  std::uint64_t blocked = 0;
  std::uint64_t others = 0;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const GivenHit& ours = frame.hits[i];
    if (ours.any != theirs[i].found()) {
      ++others;
    } else if (scene.rays.wants_any(i)) {
      blocked += ours.any ? 1 : 0;
    } else if (ours.any) {
      ++found;
      const double length = glm::length(scene.rays.rays[i].direction);
      const bool near = std::abs(ours.hit.t - theirs[i].t) * length <= 1e-4 * (1.0 + ours.hit.t * length);
      const bool same =
          ours.hit.primitive != theirs[i].primitive ||
          (std::abs(ours.hit.u - theirs[i].u) < 1e-2 && std::abs(ours.hit.v - theirs[i].v) < 1e-2 &&
           std::abs(ours.hit.w - theirs[i].w) < 1e-2);
      others += near && same ? 0 : 1;
    }
  }
  EXPECT_GT(found, 10'000U);
  EXPECT_GT(blocked, 10'000U);
  EXPECT_LE(others, 20U);  // of Debian's 3.13 with AVX-512: none
}
#endif

}  // namespace
}  // namespace marti::tests
