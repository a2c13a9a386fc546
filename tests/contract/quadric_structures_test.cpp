// The structures' contract over soups of triangles, spheres, cylinders and cones: the hits of brute force,
// bit for bit, and leaves that list what meets them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "accel/structure.h"
#include "tests/contract/hostile.h"
#include "tests/contract/hostile_quadrics.h"
#include "tests/support/long_tests.h"
#include "tests/support/same_bits.h"

namespace marti::tests {
namespace {

using accel::Hit;
using accel::Ray;
using accel::TriangleSet;

struct BuiltMix {
  std::string name;
  std::unique_ptr<accel::Structure> structure;
};

std::vector<BuiltMix> build_mixes(const std::shared_ptr<const TriangleSet>& set) {
  std::vector<BuiltMix> all;
  const auto add = [&](std::string_view kind, std::uint32_t max_objects, std::uint32_t max_level,
                       double density) {
    accel::StructureOptions options;
    options.octree.max_objects = options.bsp.max_objects = max_objects;
    options.octree.max_level = options.bsp.max_level = max_level;
    options.grid.density = density;
    all.push_back({std::string(kind) + " " + std::to_string(max_objects) + "/" + std::to_string(max_level),
                   accel::make_structure(kind, set, options)});
  };
  for (std::size_t node = 0; node < accel::bvh_node_names.size(); ++node) {
    accel::StructureOptions options;
    options.bvh.node = static_cast<accel::BvhNodeKind>(node);
    all.push_back({"bvh " + std::string(accel::bvh_node_names[node]),
                   accel::make_structure(accel::Bvh::kind_name, set, options)});
  }
  for (const std::string_view kind : accel::structure_kinds()) {
    if (kind != accel::BruteForce::kind_name && kind != accel::Bvh::kind_name) {
      add(kind, 8, 10, 4.0);
      add(kind, 3, 6, 64.0);
      add(kind, 8, 1, 0.01);
    }
  }
  return all;
}

std::string text_of(const Ray& ray) {
  std::ostringstream text;
  text.precision(17);
  text << "o " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << " d " << ray.direction.x
       << " " << ray.direction.y << " " << ray.direction.z << " t " << ray.t_min << " " << ray.t_max;
  return text.str();
}

class MixedContract {
 public:
  explicit MixedContract(std::shared_ptr<const TriangleSet> set)
      : set_(std::move(set)), oracle_(set_), all_(build_mixes(set_)) {}

  [[nodiscard]] const TriangleSet& set() const { return *set_; }
  [[nodiscard]] const scenes::Bounds& root() const { return all_.back().structure->bounds(); }
  [[nodiscard]] std::uint64_t hits() const { return hits_; }
  [[nodiscard]] std::uint64_t quadrics_hit() const { return quadrics_hit_; }

  void compare(const Ray& ray) {
    accel::NullVisitor visitor;
    const Hit expected = oracle_.closest(ray, visitor);
    hits_ += expected.found() ? 1U : 0U;
    if (expected.found() && expected.primitive >= set_->triangles()) {
      ++quadrics_hit_;
      ASSERT_EQ(expected.u, 0.0);
      ASSERT_EQ(expected.v, 0.0);
      ASSERT_EQ(expected.w, 0.0);
    }
    for (const BuiltMix& built : all_) {
      ASSERT_TRUE(test::same_bits(expected, built.structure->closest(ray)))
          << built.name << ": " << text_of(ray);
      ASSERT_EQ(expected.found(), built.structure->occluded(ray)) << built.name << ": " << text_of(ray);
    }
  }

 private:
  std::shared_ptr<const TriangleSet> set_;
  accel::BruteForce oracle_;
  std::vector<BuiltMix> all_;
  std::uint64_t hits_ = 0;
  std::uint64_t quadrics_hit_ = 0;
};

struct Mix {
  double offset;
  bool huge;
  bool triangles;
};
class MixedSoup : public ::testing::TestWithParam<Mix> {};

TEST_P(MixedSoup, SameHitsAsBruteForce) {
  const Mix& soup = GetParam();
  MixedContract contract(std::make_shared<const TriangleSet>(
      soup.triangles ? tests::hostile_soup(soup.offset, 31) : std::vector<accel::TriangleCorners>{},
      hostile_quadrics(soup.offset, 37, soup.huge)));
  QuadricRayMaker at_quadrics(contract.set(), 41);
  for (const QuadricAim aim : all_quadric_aims) {
    for (int k = 0; k < test::cases(2500); ++k) {
      contract.compare(at_quadrics.make(aim));
      if (HasFatalFailure()) {
        return;
      }
    }
  }
  if (soup.triangles) {
    RayMaker at_triangles(contract.set(), contract.root(), 43);
    for (const Aim aim : tests::all_aims) {
      for (int k = 0; k < test::cases(1500); ++k) {
        contract.compare(at_triangles.make(aim));
        if (HasFatalFailure()) {
          return;
        }
      }
    }
  }
  EXPECT_GT(contract.hits(), test::cases(10000U));
  EXPECT_GT(contract.quadrics_hit(), test::cases(5000U));
}
INSTANTIATE_TEST_SUITE_P(Structures, MixedSoup,
                         ::testing::Values(Mix{0.0, false, true}, Mix{0.0, false, false},
                                           Mix{1e3, false, true}, Mix{-1e6, false, true},
                                           Mix{1e9, false, true}, Mix{0.0, true, true},
                                           Mix{1e3, true, false}),
                         [](const auto& tested) { return std::to_string(tested.index); });

// One quadric alone: scaling it by 2^-60 to 2^60 scales the hits, bit for bit.
TEST(MixedContract, ScaleByPowersOfTwoIsExact) {
  const std::vector<scenes::Quadric> unit = hostile_quadrics(0.0, 3);
  const auto unit_set = std::make_shared<const TriangleSet>(std::vector<accel::TriangleCorners>{}, unit);
  accel::StructureOptions options;
  options.octree.max_level = 7;
  const auto reference = accel::make_structure("octree", unit_set, options);
  for (const int power : {-60, -1, 30, 60}) {
    std::vector<scenes::Quadric> scaled = unit;
    const double factor = std::ldexp(1.0, power);
    for (scenes::Quadric& quadric : scaled) {
      quadric.base *= factor;
      quadric.tip *= factor;
      quadric.radius *= factor;
      quadric.tip_radius *= factor;
    }
    const auto structure = accel::make_structure(
        "octree", std::make_shared<const TriangleSet>(std::vector<accel::TriangleCorners>{}, scaled),
        options);
    EXPECT_EQ(structure->topology().nodes.size(), reference->topology().nodes.size());
    QuadricRayMaker maker(*unit_set, 5);
    for (int k = 0; k < test::cases(8000); ++k) {
      Ray ray = maker.make(all_quadric_aims[static_cast<std::size_t>(k) % all_quadric_aims.size()]);
      const Hit expected = reference->closest(ray);
      ray.origin *= factor;
      ray.t_min *= factor;
      ray.t_max *= factor;
      const Hit got = structure->closest(ray);
      ASSERT_EQ(expected.primitive, got.primitive) << text_of(ray);
      if (expected.found()) {
        ASSERT_EQ(expected.t * factor, got.t) << text_of(ray);
      }
    }
  }
}

// A counting scalar takes the same steps and finds the same hits.
TEST(MixedContract, CountingChangesNothing) {
  const auto set = std::make_shared<const TriangleSet>(tests::hostile_soup(0.0, 3), hostile_quadrics(0.0, 3));
  for (const std::string_view kind : accel::structure_kinds()) {
    accel::StructureOptions options;
    options.octree.max_level = options.bsp.max_level = 7;
    const auto structure = accel::make_structure(kind, set, options);
    accel::visit_structure(*structure, [&](const auto& concrete) {
      QuadricRayMaker maker(*set, 7);
      accel::NullVisitor visitor;
      for (int k = 0; k < test::cases(4000); ++k) {
        const Ray ray = maker.make(all_quadric_aims[static_cast<std::size_t>(k) % all_quadric_aims.size()]);
        const Hit expected = concrete.closest(ray, visitor);
        ASSERT_TRUE(test::same_bits(expected, concrete.template closest<accel::Counted>(ray, visitor)));
      }
    });
  }
}

}  // namespace
}  // namespace marti::tests
