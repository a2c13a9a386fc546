// Closed convex surfaces seen from inside: no ray may leave them, and nothing may stand between a point of
// theirs and a light inside. Rays that begin on an edge or in a corner, where the neighbour is as near as
// rounding can tell, are the hard ones; all structures treat them alike, so comparing structures does not
// find them.
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "processors/program/render.h"
#include "processors/program/shading.h"
#include "program_scenes.h"
#include "tests/support/long_tests.h"
#include "tests/unit/scenes/gltf_file.h"
#include "tests/unit/scenes/text_scene.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;

/// The inside of a body around `center`, seen from the middle with a point light there. All walls scatter
/// and, a little, mirror.
scenes::Scene inside_of(const glm::dvec3& center) {
  scenes::Scene scene;
  scene.background = {0.0, 0.0, 1.0};
  scene.camera.eye = center;
  scene.camera.at = center + glm::dvec3(0.0, 0.0, -1.0);
  scene.camera.up = {0.0, 1.0, 0.0};
  scene.camera.vertical_fov = 2.0;
  scenes::Material& walls = scene.materials.emplace_back();
  walls.color = glm::dvec3(0.9);
  walls.reflection = 0.2;
  scenes::Light& light = scene.lights.emplace_back();
  light.position = center;
  return scene;
}

/// A box whose faces are divided into `parts` x `parts` quadrilaterals.
void add_box(scenes::Scene& scene, const glm::dvec3& center, const glm::dvec3& half, int parts) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](int u, int v) {
        glm::dvec3 p;
        p[axis] = side * half[axis];
        p[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * u / parts - 1.0);
        p[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * v / parts - 1.0);
        return center + p;
      };
      for (int u = 0; u < parts; ++u) {
        for (int v = 0; v < parts; ++v) {
          test::add_quad(scene, corner(u, v), corner(u + 1, v), corner(u + 1, v + 1), corner(u, v + 1), 0);
        }
      }
    }
  }
}

/// A sphere of triangles between circles of latitude.
void add_sphere(scenes::Scene& scene, const glm::dvec3& center, double radius, int parts) {
  const auto point = [&](int ring, int step) {
    const double polar = std::numbers::pi * ring / parts;
    const double around = 2.0 * std::numbers::pi * (step % (2 * parts)) / (2 * parts);
    const double across = ring == 0 || ring == parts ? 0.0 : std::sin(polar);
    return center +
           radius * glm::dvec3(across * std::cos(around), across * std::sin(around), std::cos(polar));
  };
  for (int ring = 0; ring < parts; ++ring) {
    for (int step = 0; step < 2 * parts; ++step) {
      if (ring > 0 && ring + 1 < parts) {
        test::add_quad(scene, point(ring, step), point(ring + 1, step), point(ring + 1, step + 1),
                       point(ring, step + 1), 0);
        continue;
      }
      const auto first = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.insert(scene.positions.end(), {point(ring, step), point(ring + 1, step),
                                                     point(ring == 0 ? 1 : ring, step + 1)});
      scene.triangles.push_back(
          {{first, first + 1, first + 2}, 0, static_cast<std::uint32_t>(scene.polygons++)});
    }
  }
}

/// The polygons with all digits of their corners.
std::string obj_of(const scenes::Scene& scene) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (const glm::dvec3& p : scene.positions) {
    text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const scenes::Triangle& triangle = scene.triangles[t];
    const bool goes_on = t > 0 && scene.triangles[t - 1].polygon == triangle.polygon;
    text << (goes_on ? "" : "\nf");
    for (std::size_t i = goes_on ? 2 : 0; i < 3; ++i) {
      text << ' ' << triangle.vertex.at(i) + 1;
    }
  }
  return text.str() + "\n";
}

/// The triangles in floats, relative to a node at `center`.
std::string gltf_of(const scenes::Scene& scene, const glm::dvec3& center) {
  scenes::testing::GltfFile file;
  std::vector<float> values;
  for (const scenes::Triangle& triangle : scene.triangles) {
    for (const std::uint32_t vertex : triangle.vertex) {
      const glm::vec3 p(scene.positions[vertex] - center);
      values.insert(values.end(), {p.x, p.y, p.z});
    }
  }
  file.json["nodes"][0]["translation"] = {center.x, center.y, center.z};
  file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", file.add_positions(values)}}}}}}}};
  return file.glb();
}

/// The scene with its triangles as a file has them.
scenes::Scene through(const std::string& form, scenes::Scene scene, const glm::dvec3& center) {
  const scenes::testing::SceneFolder folder;
  const scenes::Scene read =
      form == "OBJ" ? folder.open("a.obj", obj_of(scene))
                    : folder.open("a.glb", gltf_of(scene, form == "moved glTF" ? center : glm::dvec3(0.0)));
  EXPECT_EQ(read.triangles.size(), scene.triangles.size());
  scene.positions = read.positions;
  scene.triangles = read.triangles;
  return scene;
}

struct Lost {
  std::uint64_t rays = 0;     ///< that are no shadow rays
  std::uint64_t escaped = 0;  ///< of these
  std::uint64_t shadows = 0;
  std::uint64_t blocked = 0;  ///< of these
};

constexpr std::uint32_t usual_side = marti::test::cases(48U);

Lost lost_in(const scenes::Scene& scene, Integrator integrator, bool floats, std::uint32_t side = usual_side,
             const char* structure = "bvh") {
  RenderOptions options{.width = side, .height = side, .max_depth = 12};
  options.integrator = integrator;
  options.samples = integrator == Integrator::path ? 3 : 1;
  options.floats = floats;
  const Frame frame = Built(scene, structure).render(options);
  Lost lost;
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    const bool shadow = kind == static_cast<std::size_t>(RayKind::shadow);
    (shadow ? lost.shadows : lost.rays) += frame.rays.traced[kind];
    (shadow ? lost.blocked : lost.escaped) +=
        shadow ? frame.rays.hit[kind] : frame.rays.traced[kind] - frame.rays.hit[kind];
  }
  return lost;
}

// The camera is not turned, so rays of its diagonals and axes meet edges and corners exactly.
class ClosedScenes : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Forms, ClosedScenes, testing::Values("built", "glTF", "moved glTF", "OBJ"),
                         [](const auto& form) {
                           return std::string(1, form.param[0]) + std::to_string(form.index);
                         });

TEST_P(ClosedScenes, NoRayLeavesAndNoLightIsHidden) {
  for (const double far : {0.0, 1000.0, 1e6}) {
    const glm::dvec3 center(far, far, far);
    for (const std::string body : {"cube", "divided cube", "flat box", "sphere"}) {
      scenes::Scene scene = inside_of(center);
      if (body == "sphere") {
        add_sphere(scene, center, 2.0, 12);
      } else {
        add_box(scene, center, body == "flat box" ? glm::dvec3(3.0, 0.7, 1.3) : glm::dvec3(1.0),
                body == "cube" ? 1 : 5);
      }
      if (GetParam() != std::string("built")) {
        scene = through(GetParam(), std::move(scene), center);
      }
      for (const Integrator integrator : {Integrator::whitted, Integrator::path}) {
        for (const bool floats : {false, true}) {
          if (floats && far > 1000.0) {
            continue;  // a float's spacing there is a sixteenth of the body
          }
          const Lost lost = lost_in(scene, integrator, floats);
          EXPECT_GT(lost.shadows, usual_side * usual_side / 3);
          EXPECT_EQ(lost.escaped, 0U)
              << body << " at " << far << " of " << lost.rays << (floats ? ", floats" : "");
          EXPECT_EQ(lost.blocked, 0U)
              << body << " at " << far << " of " << lost.shadows << (floats ? ", floats" : "");
        }
      }
    }
  }
}

/// The least of the triangles' heights over those that are promised to be enough (sure_height).
template <class Real>
double least_height_over_sure(const scenes::Scene& scene) {
  glm::dvec3 lo = scene.positions.front();
  glm::dvec3 hi = lo;
  for (const glm::dvec3& p : scene.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const scenes::Triangle& triangle : scene.triangles) {
    const auto corner = [&](std::size_t k) { return scene.positions[triangle.vertex.at(k)]; };
    const glm::dvec3 sides[3] = {corner(1) - corner(0), corner(2) - corner(1), corner(0) - corner(2)};
    const double height = glm::length(glm::cross(sides[0], sides[1])) /
                          std::max({glm::length(sides[0]), glm::length(sides[1]), glm::length(sides[2])});
    const Vec3<Real> corners[3] = {Vec3<Real>(corner(0)), Vec3<Real>(corner(1)), Vec3<Real>(corner(2))};
    least = std::min(least, height / sure_height(corners, largest(Vec3<double>(hi - lo))));
  }
  return least;
}

scenes::Scene body_of(bool sphere, const glm::dvec3& center, double size) {
  scenes::Scene scene = inside_of(center);
  sphere ? add_sphere(scene, center, 2.0 * size, 12) : add_box(scene, center, glm::dvec3(size), 5);
  return scene;
}

// What floats allow follows from their spacing, a part in 2^24 of the coordinates: bodies are closed wherever
// their triangles are as high as the bound that is derived from it. The bound is not idle: from boxes of a
// 256th of it rays leave.
TEST(ClosedScenes, AreClosedInFloatsWhereTrianglesAreHighEnough) {
  std::uint64_t lost_when_low = 0;
  for (const double far : {0.0, 1000.0, 1e6}) {
    const glm::dvec3 center(far, far, far);
    for (const bool sphere : {false, true}) {
      double size = 1.0;
      for (int step = 0; far > 0.0 && step < 4; ++step) {  // towards a body that is hardly high enough
        size *= 1.05 / least_height_over_sure<float>(body_of(sphere, center, size));
      }
      ASSERT_GE(least_height_over_sure<float>(body_of(sphere, center, size)), 1.0);
      for (const char* const structure : {"octree", "bsp", "grid", "bvh"}) {
        for (const Integrator integrator : {Integrator::whitted, Integrator::path}) {
          for (const bool floats : {false, true}) {
            if (floats && structure != std::string("bvh") && marti::test::stride(0, 1) == 0) {
              continue;  // cells are walked slowly in floats
            }
            const Lost lost =
                lost_in(body_of(sphere, center, size), integrator, floats, usual_side / 2, structure);
            EXPECT_EQ(lost.escaped + lost.blocked, 0U) << (sphere ? "sphere" : "cube") << " at " << far
                                                       << " in " << structure << (floats ? ", floats" : "");
          }
        }
      }
      const Lost low = lost_in(body_of(sphere, center, size / 256.0), Integrator::path, true, 24);
      lost_when_low += low.escaped + low.blocked;
    }
  }
  EXPECT_GT(lost_when_low, 0U);
}

}  // namespace
}  // namespace marti::processors
