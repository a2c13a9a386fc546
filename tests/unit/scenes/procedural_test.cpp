// Counts, sizes and closedness of the procedural scenes. The counts and bounding sizes are those of the
// Standard Procedural Databases and of V. Havran's statistics of them.
#include "scenes/procedural.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "scenes/open.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "tests/support/user_error.h"

namespace marti::scenes {
namespace {

using Point = std::tuple<double, double, double>;

Point point_of(const Scene& scene, std::uint32_t vertex) {
  const glm::dvec3& p = scene.positions[vertex];
  return {p.x, p.y, p.z};
}

/// How many directed edges between bit-equal positions lack their opposite.
std::size_t open_edges(const Scene& scene, std::uint32_t first_polygon) {
  std::map<std::pair<Point, Point>, int> balance;
  for (const Triangle& triangle : scene.triangles) {
    for (std::size_t i = 0; i < 3 && triangle.polygon >= first_polygon; ++i) {
      const Point a = point_of(scene, triangle.vertex[i]);
      const Point b = point_of(scene, triangle.vertex[(i + 1) % 3]);
      a < b ? ++balance[{a, b}] : --balance[{b, a}];
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : balance) {
    open += count != 0 ? 1U : 0U;
  }
  return open;
}

void expect_valid(const Scene& scene) {
  for (const glm::dvec3& p : scene.positions) {
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  }
  for (const Triangle& triangle : scene.triangles) {
    EXPECT_LT(triangle.material, scene.materials.size());
    EXPECT_LT(triangle.polygon, scene.polygons);
    for (const std::uint32_t vertex : triangle.vertex) {
      EXPECT_LT(vertex, scene.positions.size());
    }
  }
  EXPECT_TRUE(scene.normals.empty() || scene.normals.size() == scene.positions.size());
  const SceneFacts facts = facts_of(scene);
  EXPECT_EQ(facts.degenerate_triangles, 0U);
  EXPECT_EQ(facts.duplicate_triangles, 0U);
}

TEST(Gears, CountsOfEverySize) {
  const std::uint64_t polygons[] = {147, 1169, 3943, 9345, 18251};
  for (std::uint32_t n = 1; n <= 5; ++n) {
    const Scene scene = make_procedural("gears:" + std::to_string(n));
    EXPECT_EQ(scene.polygons, polygons[n - 1]);
    EXPECT_EQ(scene.triangles.size(), 572ULL * n * n * n + 2);
    std::set<std::uint32_t> seen;
    for (const Triangle& triangle : scene.triangles) {
      seen.insert(triangle.polygon);
    }
    EXPECT_EQ(seen.size(), scene.polygons) << "every polygon gives at least one triangle";
    expect_valid(scene);
  }
}

TEST(Gears, AreClosedSolids) { EXPECT_EQ(open_edges(make_procedural("gears:3"), 1), 0U); }

TEST(Gears, TopsHaveTheAreaOfTheirOutline) {
  const Scene scene = make_procedural("gears:2");
  std::map<std::uint32_t, double> area;
  for (const Triangle& triangle : scene.triangles) {
    const glm::dvec3 a = scene.positions[triangle.vertex[0]];
    const glm::dvec3 n =
        glm::cross(scene.positions[triangle.vertex[1]] - a, scene.positions[triangle.vertex[2]] - a);
    area[triangle.polygon] += n.z / 2.0;  // signed: up for tops, down for bottoms, 0 for sides
    if (triangle.polygon > 0 && std::abs(n.z) > 0.0) {
      EXPECT_EQ(n.x, 0.0);
    }
  }
  // The outline in polar coordinates: each corner pair spans a triangle with the centre.
  const double pitch = 2.0 * M_PI / 36.0;
  const double radius = 1.0 / (2.0 - 0.05);
  const double outer = 0.995 * radius;
  const double inner = 0.9 * radius;
  const double expected = 36.0 * 0.5 *
                          (outer * outer * std::sin(0.38 * pitch) + outer * inner * std::sin(0.11 * pitch) +
                           inner * inner * std::sin(0.4 * pitch) + inner * outer * std::sin(0.11 * pitch));
  EXPECT_NEAR(area[1], expected, 1e-12);
  EXPECT_NEAR(area[146], -expected, 1e-12);
  EXPECT_EQ(area[0], 16.0);
}

TEST(Gears, EveryFifthIsGlass) {
  const Scene scene = make_procedural("gears:4");
  EXPECT_EQ(scene.materials.size(), 65U);
  EXPECT_EQ(scene.materials[1].transmission, 0.8);
  EXPECT_EQ(scene.materials[2].transmission, 0.0);
  for (std::size_t i = 1; i < scene.materials.size(); ++i) {
    const glm::dvec3& c = scene.materials[i].color;
    EXPECT_EQ(std::max({c.r, c.g, c.b}), 1.0);
  }
}

TEST(Teapot, Counts) {
  EXPECT_EQ(make_procedural("teapot:12:pot").triangles.size(), 9120U);
  EXPECT_EQ(make_procedural("teapot:4:pot").triangles.size(), 992U);
  for (const std::uint32_t n : {2U, 3U, 5U, 12U}) {
    const Scene scene = make_procedural("teapot:" + std::to_string(n));
    EXPECT_EQ(scene.polygons, 64U * n * n - 8U * n + n * n);
    EXPECT_EQ(scene.triangles.size(), 64U * n * n - 8U * n + 2U * n * n);
    expect_valid(scene);
  }
}

TEST(Teapot, PatchesMeetBitForBit) {
  // Open are only the rims: lid against body, the lower edges of spout and handle, the spout's mouth. What
  // the table says is shared must be shared: closing all seams of 32 patches leaves these edges alone.
  const std::uint32_t n = 6;
  const Scene scene = make_procedural("teapot:6:pot");
  std::map<std::pair<Point, Point>, int> uses;
  for (const Triangle& triangle : scene.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      Point a = point_of(scene, triangle.vertex[i]);
      Point b = point_of(scene, triangle.vertex[(i + 1) % 3]);
      if (b < a) {
        std::swap(a, b);
      }
      ++uses[{a, b}];
    }
  }
  // An almost-equal vertex would leave pairs of open edges a few ulps apart: look for such twins.
  std::set<Point> open;
  for (const auto& [edge, count] : uses) {
    if (count == 1) {
      open.insert(edge.first);
      open.insert(edge.second);
    }
    EXPECT_LE(count, 2);
  }
  for (const Point& a : open) {
    for (const Point& b : open) {
      const double distance = std::abs(std::get<0>(a) - std::get<0>(b)) +
                              std::abs(std::get<1>(a) - std::get<1>(b)) +
                              std::abs(std::get<2>(a) - std::get<2>(b));
      EXPECT_TRUE(a == b || distance > 1e-6) << "two vertices that should be one";
    }
  }
  EXPECT_LE(open.size(), 4U * n * 6U) << "six rims of at most four patches each";
}

TEST(Teapot, NormalsPointOutwardsAlongTheSurface) {
  const Scene scene = make_procedural("teapot:8");
  ASSERT_EQ(scene.normals.size(), scene.positions.size());
  for (const glm::dvec3& normal : scene.normals) {
    EXPECT_NEAR(glm::length(normal), 1.0, 1e-12);
  }
  for (const Triangle& triangle : scene.triangles) {
    const glm::dvec3 a = scene.positions[triangle.vertex[0]];
    const glm::dvec3 facet = glm::normalize(
        glm::cross(scene.positions[triangle.vertex[1]] - a, scene.positions[triangle.vertex[2]] - a));
    for (const std::uint32_t vertex : triangle.vertex) {
      EXPECT_GT(glm::dot(facet, scene.normals[vertex]), 0.0);
    }
  }
}

TEST(Tetra, CountsAndClosedness) {
  for (std::uint32_t n = 1; n <= 6; ++n) {
    const Scene scene = make_procedural("tetra:" + std::to_string(n));
    EXPECT_EQ(scene.triangles.size(), std::uint64_t{1} << (2 * n));
    EXPECT_EQ(scene.polygons, scene.triangles.size());
    EXPECT_EQ(open_edges(scene, 0), 0U);
    expect_valid(scene);
  }
  EXPECT_EQ(make_procedural("tetra:6").triangles.size(), 4096U);
  EXPECT_EQ(make_procedural("tetra:6").positions.size(), 2050U) << "2 * 4^(n-1) + 2 corners in all";
}

TEST(Procedural, BoundingSizes) {
  const auto size_of = [](const char* spec) {
    const Bounds bounds = bounds_of(make_procedural(spec));
    return bounds.hi - bounds.lo;
  };
  EXPECT_EQ(size_of("gears:4"), glm::dvec3(4.0, 4.0, 1.0));
  EXPECT_EQ(size_of("tetra:6"), glm::dvec3(2.0));
  EXPECT_EQ(size_of("teapot:12"), glm::dvec3(8.0, 8.0, 3.15));
  const Bounds pot = bounds_of(make_procedural("teapot:12:pot"));
  EXPECT_NEAR(pot.lo.x, -3.0, 1e-12);
  EXPECT_NEAR(pot.hi.x, 3.434, 5e-4);
  EXPECT_NEAR(pot.hi.y, 2.0, 1e-12);
  EXPECT_NEAR(pot.lo.y, -2.0, 1e-12);
}

TEST(Procedural, LightsAndMaterialsFollowTheConventions) {
  const Scene gears = make_procedural("gears:1");
  ASSERT_EQ(gears.lights.size(), 5U);
  for (const Light& light : gears.lights) {
    EXPECT_DOUBLE_EQ(light.color.r, std::sqrt(5.0) / 10.0);
    EXPECT_FALSE(light.inverse_square);
  }
  EXPECT_NEAR(gears.materials[0].shininess, 3.0827, 5e-5);
  EXPECT_EQ(gears.background, glm::dvec3(0.078, 0.361, 0.753));
  const Scene teapot = make_procedural("teapot:2");
  ASSERT_EQ(teapot.materials.size(), 3U);
  EXPECT_NEAR(teapot.materials[1].shininess, 4.8188, 5e-5);
  EXPECT_NEAR(teapot.ambient.r, 0.35355, 1e-5);
}

TEST(Procedural, DefaultsAndNames) {
  EXPECT_EQ(make_procedural("teapot").name, "teapot:12");
  EXPECT_EQ(make_procedural("teapot:5:pot").name, "teapot:5:pot");
  for (const ProceduralScene& entry : procedural_scenes()) {
    EXPECT_FALSE(entry.meaning.empty());
    const std::string smallest = std::string(entry.name) + ":" + std::to_string(entry.minimum_size);
    const Scene scene = make_procedural(smallest);
    EXPECT_GT(scene.triangles.size() + scene.quadrics.size(), 0U);
    const std::string beyond = std::string(entry.name) + ":" + std::to_string(entry.maximum_size + 1);
    EXPECT_THROW(static_cast<void>(make_procedural(beyond)), sim::UserError);
    for (const ProceduralVariant& variant : entry.variants) {
      EXPECT_GT(make_procedural(smallest + ":" + std::string(variant.name)).triangles.size(), 0U);
    }
  }
}

TEST(Procedural, MemoryIsEstimatedBeforeASceneIsMade) {
  for (const ProceduralScene& entry : procedural_scenes()) {
    for (const std::uint32_t n : {entry.minimum_size, entry.default_size}) {
      const std::string spec = std::string(entry.name) + ":" + std::to_string(n);
      const Scene scene = make_procedural(spec);
      EXPECT_EQ(scene.triangles.size() + scene.quadrics.size(), entry.primitives(n)) << spec;
      EXPECT_THROW(static_cast<void>(make_procedural(spec, sim::MemoryBudget(host_bytes(scene)))),
                   sim::KeyError)
          << spec;
    }
  }
}

TEST(Procedural, RefusesWithAReason) {
  const auto reason = [](const std::string& spec) {
    return test::user_error_of([&] { static_cast<void>(make_procedural(spec)); });
  };
  EXPECT_NE(reason("taepot:3").find("teapot"), std::string::npos);
  EXPECT_NE(reason("taepot:3").find("did you mean"), std::string::npos);
  for (const char* size : {"", "x", "-1", "0", "4.5", "99999999999999999999", " 4", "4 "}) {
    EXPECT_NE(reason(std::string("gears:") + size).find("whole number from 1 to 30"), std::string::npos)
        << size;
  }
  EXPECT_NE(reason("gears:4:pot").find("no variants"), std::string::npos);
  EXPECT_NE(reason("teapot:4:").find("no such variant"), std::string::npos);
  EXPECT_NE(reason("teapot:4:pots").find("did you mean"), std::string::npos);
  EXPECT_NE(reason("").find("no procedural scene"), std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
