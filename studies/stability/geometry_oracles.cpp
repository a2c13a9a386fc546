#include "studies/stability/geometry_oracles.h"

#include <bit>
#include <utility>

#include "accel/brute_force.h"

namespace marti::studies::stability {

namespace {

using accel::Hit;
using accel::Ray;
using accel::Structure;
using accel::TriangleSet;

}  // namespace

bool same_hit(const Hit& a, const Hit& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return a.primitive == b.primitive && same(a.t, b.t) && same(a.u, b.u) && same(a.v, b.v) && same(a.w, b.w);
}

std::vector<std::unique_ptr<Structure>> build_structures(const std::shared_ptr<const TriangleSet>& triangles,
                                                         bool deep) {
  std::vector<std::unique_ptr<Structure>> all;
  accel::StructureOptions options;
  all.push_back(accel::make_structure("octree", triangles, options));
  all.push_back(accel::make_structure("bsp", triangles, options));
  all.push_back(accel::make_structure("grid", triangles, options));
  all.push_back(accel::make_structure("bvh", triangles, options));
  options.bsp.walk = accel::BspWalk::push_point;
  all.push_back(accel::make_structure("bsp", triangles, options));
  if (!deep) {
    return all;
  }
  for (const auto node :
       {accel::BvhNodeKind::two, accel::BvhNodeKind::four, accel::BvhNodeKind::eight_quantised}) {
    options.bvh = {.node = node, .max_objects = 1};
    all.push_back(accel::make_structure("bvh", triangles, options));
  }
  options.octree.max_objects = 2;
  options.octree.max_level = 11;
  options.bsp.max_objects = 2;
  options.bsp.max_level = 9;
  all.push_back(accel::make_structure("octree", triangles, options));
  all.push_back(accel::make_structure("bsp", triangles, options));
  options.octree.max_level = 6;
  options.grid_match = accel::GridMatch::octree_cells;
  all.push_back(accel::make_structure("grid", triangles, options));
  all.push_back(accel::make_lazy_octree(triangles));
  return all;
}

Tally disagreements(const TriangleSet& triangles, const Tracer& oracle,
                    const std::vector<std::unique_ptr<Structure>>& structures, const scenes::Bounds& box,
                    Aim aim, std::uint32_t rays, std::uint64_t seed) {
  Tally tally;
  RayMaker maker(triangles, box, seed);
  for (std::uint32_t k = 0; k < rays; ++k) {
    const Ray ray = maker.make(aim);
    const Hit expected = oracle(ray);
    bool good = true;
    for (const auto& structure : structures) {
      good =
          good && same_hit(expected, structure->closest(ray)) && structure->occluded(ray) == expected.found();
    }
    tally.add(good);
  }
  return tally;
}

Tally disagreements(std::vector<accel::TriangleCorners> corners, std::uint32_t rays, std::uint64_t seed,
                    bool deep) {
  const auto triangles = std::make_shared<const TriangleSet>(std::move(corners));
  const accel::BruteForce brute(triangles);
  const auto structures = build_structures(triangles, deep);
  const Tracer oracle = tracer_of(brute);
  Tally all;
  for (const Aim aim : all_aims) {
    all += disagreements(*triangles, oracle, structures, structures[0]->bounds(), aim,
                         rays / static_cast<std::uint32_t>(all_aims.size()) + 1,
                         seed + static_cast<std::uint64_t>(aim));
  }
  return all;
}

PlacedSphere::PlacedSphere(int times, double offset, double scale)
    : sphere(times), center(offset, -offset, 0.5 * offset), size(scale) {
  for (const glm::dvec3& v : sphere.vertices) {
    vertices.push_back(center + size * v);
  }
  for (const auto& [a, b, c] : sphere.faces) {
    triangles.push_back(corners(vertices[a], vertices[b], vertices[c]));
  }
}

Tally leaks(const PlacedSphere& mesh, const Tracer& trace, std::uint32_t rays, std::uint64_t seed) {
  Random random(seed);
  Tally tally;
  for (std::uint32_t k = 0; k < rays; ++k) {
    Ray ray;
    ray.origin = mesh.center + 0.9 * mesh.size * random.unit() * random.direction();
    const auto& face = mesh.sphere.faces[random.below(static_cast<std::uint32_t>(mesh.sphere.faces.size()))];
    const std::uint32_t first = random.below(3);
    const glm::dvec3 a = mesh.vertices[face[first]];
    const glm::dvec3 b = mesh.vertices[face[(first + 1) % 3]];
    const glm::dvec3 c = mesh.vertices[face[(first + 2) % 3]];
    const double along = k % 3 == 0 ? 0.0 : random.unit();
    const double across = k % 3 == 2 ? random.unit() : 0.0;
    ray.direction = a + along * ((b - a) + across * (c - b)) - ray.origin;
    if (ray.direction == glm::dvec3(0.0)) {
      ray.direction = {1.0, 0.0, 0.0};
    }
    tally.add(trace(ray).found());
  }
  return tally;
}

}  // namespace marti::studies::stability
