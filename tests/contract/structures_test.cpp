// Every structure must find the hits of brute force, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "accel/mailbox.h"
#include "accel/structure.h"
#include "scenes/procedural.h"
#include "tests/contract/hostile.h"
#include "tests/support/holed_scene.h"
#include "tests/support/kernel_check.h"
#include "tests/support/long_tests.h"
#include "tests/support/same_bits.h"

namespace marti::tests {
namespace {

using accel::Hit;
using accel::Ray;
using accel::Structure;
using accel::TriangleSet;
using tests::TestCounter;

/// A structure and how it was made.
struct Built {
  std::string name;
  std::unique_ptr<Structure> structure;
  accel::Mailboxed<TestCounter> mailboxes{};
};

/// As many primitives, each triangle where another one was.
std::shared_ptr<const TriangleSet> elsewhere(const TriangleSet& triangles) {
  std::vector<accel::TriangleCorners> corners;
  for (std::uint32_t i = 0; i < triangles.triangles(); ++i) {
    corners.push_back(triangles[(i * 7919U + 13U) % triangles.triangles()]);
  }
  scenes::Quadric sphere;
  sphere.radius = 1.0;
  const std::vector<scenes::Quadric> spheres(triangles.size() - triangles.triangles(), sphere);
  return std::make_shared<const TriangleSet>(std::move(corners), spheres);
}

/// Every kind, in several shapes: the default, the deepest possible, shallow, one single leaf.
std::vector<Built> build_all(const std::shared_ptr<const TriangleSet>& triangles) {
  std::vector<Built> all;
  const auto add = [&](std::string_view kind, std::uint32_t max_objects, std::uint32_t max_level,
                       accel::BspWalk walk = accel::BspWalk::recursive) {
    accel::StructureOptions options;
    options.bsp.walk = walk;
    options.octree.max_objects = max_objects;
    options.octree.max_level = max_level;
    options.bsp.max_objects = max_objects;
    options.bsp.max_level = max_level;
    all.push_back({std::string(kind) + " " + std::to_string(max_objects) + "/" + std::to_string(max_level),
                   accel::make_structure(kind, triangles, options)});
  };
  add("octree", 8, 12);
  add("octree", 2, 11);
  add("octree", 3, 5);
  add("octree", 8, 1);
  add("bsp", 8, 12);
  add("bsp", 2, 9);
  add("bsp", 8, 1);
  add("bsp", 8, 12, accel::BspWalk::push_point);
  add("bsp", 2, 9, accel::BspWalk::push_point);
  add("bsp", 8, 1, accel::BspWalk::push_point);
  const auto add_grid = [&](double density, std::array<std::uint32_t, 3> resolution,
                            accel::GridMatch match = accel::GridMatch::density) {
    accel::StructureOptions options;
    options.grid_match = match;
    options.octree.max_level = 6;
    options.grid.density = density;
    options.grid.resolution = resolution;
    all.push_back({"grid", accel::make_structure("grid", triangles, options)});
  };
  add_grid(4.0, {0, 0, 0});
  add_grid(1.0, {32, 32, 32});  // its planes are the octree's
  add_grid(1.0, {1, 7, 64});
  add_grid(1.0, {1, 1, 1});
  add_grid(1.0, {0, 0, 0}, accel::GridMatch::octree_nodes);
  add_grid(1.0, {0, 0, 0}, accel::GridMatch::octree_cells);
  const auto add_bvh = [&](accel::BvhNodeKind node, std::uint32_t max_objects, std::uint32_t bins = 32) {
    accel::StructureOptions options;
    options.bvh = {.node = node, .max_objects = max_objects, .bins = bins};
    all.push_back({"bvh " + std::string(accel::bvh_node_names[static_cast<std::size_t>(node)]) + ", " +
                       std::to_string(max_objects),
                   accel::make_structure("bvh", triangles, options)});
  };
  add_bvh(accel::BvhNodeKind::two, 4);
  add_bvh(accel::BvhNodeKind::two, 1, 2);
  add_bvh(accel::BvhNodeKind::four, 4);
  add_bvh(accel::BvhNodeKind::six, 15);
  add_bvh(accel::BvhNodeKind::six, 1, 16);
  add_bvh(accel::BvhNodeKind::eight, 4);
  add_bvh(accel::BvhNodeKind::eight, 64, 64);
  add_bvh(accel::BvhNodeKind::eight_quantised, 3);
  add_bvh(accel::BvhNodeKind::eight_quantised, 1, 16);
  for (std::size_t node = 0; node < accel::bvh_node_names.size(); ++node) {
    const accel::Bvh other = accel::Bvh::build(elsewhere(*triangles),
                                               {.node = static_cast<accel::BvhNodeKind>(node), .threads = 1});
    all.push_back({"refitted bvh " + std::string(accel::bvh_node_names[node]),
                   std::make_unique<accel::StructureOf<accel::Bvh>>(other.refitted(triangles))});
  }
  add("none", 8, 12);
  return all;
}

/// The same hits with mailboxes, and no more tests.
void compare_with_mailboxes(Built& built, const Ray& ray, const Hit& expected) {
  accel::visit_structure(*built.structure, [&](const auto& concrete) {
    accel::Mailboxed<TestCounter>& with = built.mailboxes;
    with.prepare(concrete.triangles().size());
    TestCounter without;
    with.tests = 0;
    static_cast<void>(concrete.closest(ray, without));
    EXPECT_TRUE(test::same_bits(expected, concrete.closest(ray, with)));
    EXPECT_LE(with.tests, without.tests);
    with.tests = 0;
    without.tests = 0;
    static_cast<void>(concrete.occluded(ray, without));
    EXPECT_EQ(expected.found(), concrete.occluded(ray, with));
    EXPECT_LE(with.tests, without.tests);
  });
}

/// `rays` rays of each class; returns how many hit something. expected_of(ray): the hit. `all_kinds`: also of
/// brute force.
template <class ExpectedOf>
std::uint64_t compare(const std::shared_ptr<const TriangleSet>& triangles, std::uint32_t rays,
                      std::uint64_t seed, const ExpectedOf& expected_of, bool all_kinds) {
  std::vector<Built> all = build_all(triangles);
  RayMaker maker(*triangles, all[0].structure->bounds(), seed);
  std::uint64_t hits = 0;
  for (const Aim aim : tests::all_aims) {
    for (std::uint32_t k = 0; k < rays; ++k) {
      const Ray ray = maker.make(aim);
      const Hit expected = expected_of(ray);
      hits += expected.found() ? 1U : 0U;
      for (Built& built : all) {
        if (built.structure->kind() == "none" && !all_kinds) {
          continue;  // the oracle itself
        }
        if (built.structure->topology().nodes.size() == 1 && k % 8 != 0) {
          continue;  // its walk is the oracle's loop
        }
        const auto where = [&] {
          std::ostringstream text;
          text.precision(17);
          text << built.name << ", aim " << static_cast<int>(aim) << ", ray " << k << ": o " << ray.origin.x
               << " " << ray.origin.y << " " << ray.origin.z << " d " << ray.direction.x << " "
               << ray.direction.y << " " << ray.direction.z << " t " << ray.t_min << " " << ray.t_max;
          return text.str();
        };
        EXPECT_TRUE(test::same_bits(expected, built.structure->closest(ray))) << where();
        EXPECT_EQ(expected.found(), built.structure->occluded(ray)) << where();
        if (k % 16 == 0) {
          SCOPED_TRACE(where());
          compare_with_mailboxes(built, ray, expected);
        }
        if (::testing::Test::HasFailure()) {
          return hits;
        }
      }
    }
  }
  return hits;
}

std::uint64_t compare_with_brute_force(std::vector<accel::TriangleCorners> corners, std::uint32_t rays,
                                       std::uint64_t seed) {
  const auto triangles = std::make_shared<const TriangleSet>(std::move(corners));
  const accel::BruteForce oracle(triangles);
  accel::NullVisitor visitor;
  return compare(
      triangles, rays, seed, [&](const Ray& ray) { return oracle.closest(ray, visitor); }, false);
}

std::vector<accel::TriangleCorners> corners_of(std::string_view scene) {
  const TriangleSet set(scenes::make_procedural(scene));
  std::vector<accel::TriangleCorners> all;
  for (std::uint32_t id = 0; id < set.size(); ++id) {
    all.push_back(set[id]);
  }
  return all;
}

// Rays of each of the 9 classes. In the long run 9 x 5,000 x 3 scenes x 4 parts and 9 x 5,000 x 8 soups x 2
// parts are 1,260,000 rays; in the short run a sixth, and a fifth of that under the sanitizers.
const auto rays_of_class = static_cast<std::uint32_t>(test::cases(test::stride(800, 5000)));

class SceneContract : public ::testing::TestWithParam<std::tuple<std::string, unsigned>> {};

TEST_P(SceneContract, SameHitsAsBruteForce) {
  const auto [scene, part] = GetParam();
  EXPECT_GT(compare_with_brute_force(corners_of(scene), rays_of_class, 7 + part), 3 * rays_of_class);
}
INSTANTIATE_TEST_SUITE_P(Structures, SceneContract,
                         ::testing::Combine(::testing::Values(std::string("teapot:3"), std::string("gears:1"),
                                                              std::string("tetra:4")),
                                            ::testing::Range(0U, 4U)),
                         [](const auto& tested) {
                           std::string name = std::get<0>(tested.param);
                           name[name.find(':')] = '_';
                           return name + "_" + std::to_string(std::get<1>(tested.param));
                         });

// The triangles of a soup, many of them one behind the other, three quarters of them with textures.
TEST(HolesContract, SameHitsAsEachTriangleByItself) {
  scenes::Scene soup;
  for (const accel::TriangleCorners& corners : tests::hostile_soup(0.0, 3)) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (std::size_t k = 0; k < 9; k += 3) {
      soup.positions.emplace_back(corners[k], corners[k + 1], corners[k + 2]);
    }
    soup.triangles.push_back({{first, first + 1, first + 2}, 0, first / 3});
  }
  const scenes::Scene scene = test::holed(std::move(soup));
  const auto triangles = std::make_shared<const TriangleSet>(scene);
  ASSERT_NE(triangles->cut_outs(), nullptr);
  test::NaiveHoles naive(scene);
  const auto rays = static_cast<std::uint32_t>(test::cases(test::stride(200, 2000)));
  const std::uint64_t hits = compare(
      triangles, rays, 5, [&](const Ray& ray) { return naive.closest(ray); }, true);
  EXPECT_GT(hits, 2 * rays);
  EXPECT_GT(naive.asked, hits / 2);
}

struct Soup {
  double offset;
  bool huge;
};
void PrintTo(const Soup& soup, std::ostream* out) {
  *out << (soup.huge ? "huge " : "") << "soup at " << soup.offset;
}
class SoupContract : public ::testing::TestWithParam<Soup> {};

TEST_P(SoupContract, SameHitsAsBruteForce) {
  EXPECT_GT(compare_with_brute_force(tests::hostile_soup(GetParam().offset, 11, GetParam().huge),
                                     rays_of_class, 13),
            2 * rays_of_class);
}

TEST_P(SoupContract, SameHitsAsBruteForceWithOtherRays) {
  EXPECT_GT(compare_with_brute_force(tests::hostile_soup(GetParam().offset, 11, GetParam().huge),
                                     rays_of_class, 14),
            2 * rays_of_class);
}

// All corners exactly in planes of the tree, down to level 6.
TEST_P(SoupContract, SameHitsWithTrianglesInCellPlanes) {
  std::vector<accel::TriangleCorners> soup = tests::hostile_soup(GetParam().offset, 19, GetParam().huge);
  const auto bounds = accel::make_structure("octree", std::make_shared<const TriangleSet>(soup))->bounds();
  const TriangleSet tight(soup);
  for (auto& triangle : soup) {
    for (std::size_t k = 0; k < 9; ++k) {
      const int a = static_cast<int>(k % 3);
      if (triangle[k] != tight.bounds().lo[a] && triangle[k] != tight.bounds().hi[a]) {  // keep the root
        const double extent = bounds.hi[a] - bounds.lo[a];
        const double i = std::clamp(std::round((triangle[k] - bounds.lo[a]) / extent * 32.0), 1.0, 31.0);
        triangle[k] = bounds.lo[a] + extent * (i / 32.0);
      }
    }
  }
  ASSERT_EQ(TriangleSet(soup).bounds().lo, tight.bounds().lo);
  ASSERT_EQ(TriangleSet(soup).bounds().hi, tight.bounds().hi);
  EXPECT_GT(compare_with_brute_force(soup, rays_of_class, 29), rays_of_class);
}
INSTANTIATE_TEST_SUITE_P(Structures, SoupContract,
                         ::testing::Values(Soup{0.0, false}, Soup{1e3, false}, Soup{-1e3, false},
                                           Soup{1e6, false}, Soup{1e9, false}, Soup{0.0, true},
                                           Soup{1e3, true}, Soup{1e6, true}),
                         [](const auto& tested) { return std::to_string(tested.index); });

// Scaling a scene by 2^-60 to 2^60 scales the hits, bit for bit.
TEST(StructureContract, ScaleByPowersOfTwoIsExact) {
  const std::vector<accel::TriangleCorners> unit = tests::hostile_soup(0.0, 3);
  const auto unit_set = std::make_shared<const TriangleSet>(unit);
  const auto reference = accel::make_structure("octree", unit_set);
  RayMaker maker(*unit_set, reference->bounds(), 5);
  std::vector<std::pair<Ray, Hit>> expected;
  for (int k = 0; k < test::cases(20000); ++k) {
    const Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % 6]);
    expected.emplace_back(ray, reference->closest(ray));
  }
  for (const int power : {-60, -30, -1, 1, 30, 60}) {
    std::vector<accel::TriangleCorners> scaled = unit;
    for (auto& triangle : scaled) {
      for (double& x : triangle) {
        x = std::ldexp(x, power);
      }
    }
    const auto scaled_set = std::make_shared<const TriangleSet>(scaled);
    for (const std::string_view kind : {"octree", "bsp", "grid", "bvh"}) {
      const auto structure = accel::make_structure(kind, scaled_set);
      EXPECT_EQ(structure->topology().nodes.size(),
                accel::make_structure(kind, unit_set)->topology().nodes.size());
      for (auto [ray, hit] : expected) {
        ray.origin *= std::ldexp(1.0, power);
        ray.t_min = std::ldexp(ray.t_min, power);
        ray.t_max = std::ldexp(ray.t_max, power);
        Hit got = structure->closest(ray);
        got.t = std::ldexp(got.t, -power);
        ASSERT_TRUE(test::same_bits(hit, got)) << kind << ", 2^" << power;
      }
    }
  }
}

// Degenerate inputs that are known to break structures.
class DegenerateScene : public ::testing::TestWithParam<int> {};

std::vector<accel::TriangleCorners> degenerate_scene(int which) {
  std::vector<accel::TriangleCorners> all;
  Random random(23);
  switch (which) {
    case 0:
      all.push_back(tests::corners({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
      break;
    case 1:
      all.push_back(tests::corners({1, 2, 3}, {1, 2, 3}, {1, 2, 3}));
      break;
    case 2:
      all.push_back(tests::corners({0, 0, 0}, {1, 1, 1}, {2, 2, 2}));
      break;
    case 3:
    case 4:
    case 5:
      for (int i = 0; i < 200; ++i) {  // flat, in each axis plane
        const glm::dvec3 flatten = glm::dvec3(which != 3, which != 4, which != 5);
        const glm::dvec3 a = random.in_box(glm::dvec3(-1.0), glm::dvec3(1.0));
        all.push_back(tests::corners(a * flatten, (a + 0.3 * random.direction()) * flatten,
                                     (a + 0.3 * random.direction()) * flatten));
      }
      break;
    case 6:
      for (int i = 0; i < 200; ++i) {  // near the smallest and largest sizes at once
        const double size = std::pow(10.0, random.between(-18.0, 18.0));
        const glm::dvec3 a = size * random.direction();
        all.push_back(tests::corners(a, a + size * random.direction(), a + size * random.direction()));
      }
      break;
    case 9:
      all.push_back(tests::corners({0, 0, 0}, {0, 0, 0}, {0, 0, 0}));
      break;
    case 8:
      all.assign(2000, tests::corners({-1, -1, -1}, {1, 0.3, 0.2}, {0.1, 1, 1}));
      break;
    default:
      for (int i = 0; i < 500; ++i) {  // coincident, in three orders
        all.push_back(tests::corners({-1, -1, -1}, {1, 0.3, 0.2}, {0.1, 1, 1}));
        if (i % 3 == 0) {
          all.push_back(tests::corners({1, 0.3, 0.2}, {0.1, 1, 1}, {-1, -1, -1}));
        }
      }
      break;
  }
  return all;
}

TEST_P(DegenerateScene, SameHitsAsBruteForce) {
  std::vector<accel::TriangleCorners> scene = degenerate_scene(GetParam());
  const auto rays = static_cast<std::uint32_t>(scene.size() < 2000 ? test::stride(100, 1000)
                                                                   : test::cases(std::size_t{100}));
  const std::uint64_t hits = compare_with_brute_force(std::move(scene), rays, 17);
  if (GetParam() == 1 || GetParam() == 9) {
    EXPECT_EQ(hits, 0U);
  } else if (GetParam() != 2) {
    EXPECT_GT(hits, rays / 10);
  }
}
INSTANTIATE_TEST_SUITE_P(Structures, DegenerateScene, ::testing::Range(0, 10));

TEST(StructureContract, NothingToHit) {
  const auto none = std::make_shared<const TriangleSet>();
  for (const Built& built : build_all(none)) {
    EXPECT_TRUE(built.structure->bounds().empty());
    ASSERT_EQ(built.structure->topology().nodes.size(), 1U);
    EXPECT_TRUE(built.structure->topology().nodes[0].leaf);
    Random random(1);
    EXPECT_FALSE(built.structure->closest({}).found());
    for (int k = 0; k < 100; ++k) {
      const Ray ray{random.direction(), random.direction()};
      EXPECT_FALSE(built.structure->closest(ray).found());
      EXPECT_FALSE(built.structure->occluded(ray));
    }
  }
}

TEST(StructureContract, RefusesRaysThatAreNone) {
  const auto set = std::make_shared<const TriangleSet>(tests::hostile_soup(0.0, 1));
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Built& built : build_all(set)) {
    for (const Ray& ray :
         {Ray{{0, 0, 0}, {0, 0, 0}}, Ray{{0, 0, 0}, {0, -0.0, 0}}, Ray{{0, 0, 0}, {0, nan, 1}},
          Ray{{0, 0, 0}, {inf, 0, 1}}, Ray{{nan, 0, 0}, {0, 0, 1}}, Ray{{0, inf, 0}, {0, 0, 1}},
          Ray{{0, 0, 0}, {1e-310, 0, 0}}}) {
      EXPECT_THROW((void)built.structure->closest(ray), sim::InternalError);
      EXPECT_THROW((void)built.structure->occluded(ray), sim::InternalError);
    }
  }
}

TEST(StructureContract, KnowsItsKinds) {
  const auto set = std::make_shared<const TriangleSet>(tests::hostile_soup(0.0, 1));
  for (const std::string_view kind : accel::structure_kinds()) {
    const auto structure = accel::make_structure(kind, set);
    EXPECT_EQ(structure->kind(), kind);
    EXPECT_EQ(accel::visit_structure(*structure, [](const auto& concrete) { return concrete.kind_name; }),
              kind);
  }
  EXPECT_THROW((void)accel::make_structure("quadtree", set), sim::UserError);
}

}  // namespace
}  // namespace marti::tests
