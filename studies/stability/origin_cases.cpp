// Cases of rays that begin on a surface: they must neither hit it again nor begin behind the next one.
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "processors/program/shading.h"
#include "studies/stability/geometry_oracles.h"

namespace marti::studies::stability {

namespace {

using accel::Hit;
using accel::Ray;
using Vec = processors::program::Vec3<double>;

scenes::Scene scene_of(const PlacedSphere& mesh) {
  scenes::Scene scene;
  scene.positions = mesh.vertices;
  for (const auto& face : mesh.sphere.faces) {
    scene.triangles.push_back({face, 0, 0});
  }
  scene.materials.emplace_back();
  return scene;
}

processors::program::Surface<double> surface_of(const scenes::Scene& scene, const Ray& eye, const Hit& hit) {
  const double weights[3] = {hit.u, hit.v, hit.w};
  return processors::program::surface_at(scene, hit.primitive, weights, Vec(eye.direction), 0.0);
}

Ray leaving(const processors::program::Surface<double>& surface, const Vec& direction) {
  const Vec origin = processors::program::leave(surface, direction);
  Ray ray{{origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z}};
  ray.t_min = std::numeric_limits<double>::denorm_min();
  return ray;
}

/// A convex mesh: from its surface every ray outwards is free, and every ray inwards hits.
CaseOutcome convex(double offset, double scale, const CaseSize& size) {
  const PlacedSphere mesh(4, offset, scale);
  const scenes::Scene scene = scene_of(mesh);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
  const accel::Octree octree = accel::Octree::build(triangles);
  accel::NullVisitor visitor;
  Random random(51);
  Tally outwards;
  Tally inwards;
  for (std::uint32_t k = 0; k < size.rays; ++k) {
    Ray eye{mesh.center + 3.0 * scale * random.direction(), {}};
    eye.direction = mesh.center + 0.5 * scale * random.direction() - eye.origin;
    const Hit hit = octree.closest(eye, visitor);
    if (!hit.found()) {
      continue;
    }
    const processors::program::Surface<double> surface = surface_of(scene, eye, hit);
    Vec direction(random.direction());
    const double cosine = processors::program::dot(surface.geometric, direction);
    if (std::abs(cosine) < 0.01) {
      continue;  // grazing: whether a triangle of a rounded mesh is met is a matter of that rounding
    }
    const bool found = octree.closest(leaving(surface, direction), visitor).found();
    (cosine > 0.0 ? outwards : inwards).add(found == (cosine < 0.0));
  }
  CaseOutcome outcome = none_wrong({outwards.wrong + inwards.wrong, outwards.of + inwards.of}, "rays wrong");
  outcome.figure += fmt::format("; {} outwards hit, {} inwards passed", tables::grouped(outwards.wrong),
                                tables::grouped(inwards.wrong));
  return outcome;
}

/// Two sheets 2^-k apart, seen from below: the ray that leaves the first upwards must hit the second. The
/// figure is the narrowest gap that is not jumped, in steps of the doubles there.
CaseOutcome thin_gap(double height) {
  int narrowest = -1;
  const double step = std::nextafter(height, 2.0 * height) - height;
  for (int k = 30; k >= 0; --k) {
    const double upper = height + std::ldexp(step, k);
    scenes::Scene scene;
    for (const double z : {height, upper}) {
      const auto first = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.insert(scene.positions.end(), {{-1, -1, z}, {3, -1, z}, {-1, 3, z}});
      scene.triangles.push_back({{first, first + 1, first + 2}, 0, 0});
    }
    const auto triangles = std::make_shared<const accel::TriangleSet>(scene);
    const accel::Octree octree = accel::Octree::build(triangles);
    accel::NullVisitor visitor;
    const Ray eye{{0.2, 0.1, height - 1.0}, {0.05, 0.03, 1.0}};
    const Hit hit = octree.closest(eye, visitor);
    const Ray ray = leaving(surface_of(scene, eye, hit), Vec(0.05, 0.03, 1.0));
    if (hit.primitive != 0 || octree.closest(ray, visitor).primitive != 1) {
      break;
    }
    narrowest = k;
  }
  // The error bound is gamma(7) of the coordinates and 2^-48 of the triangle: some 64 steps and a few more.
  return {fmt::format("gaps from 2^{} steps of a double on are seen", narrowest),
          narrowest < 0 ? 31.0 : static_cast<double>(narrowest), 8.0};
}

}  // namespace

void add_origin_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::geometry);
  struct Place {
    const char* id;
    double offset;
    double scale;
  };
  for (const Place& place :
       {Place{"origins", 0.0, 1.0}, Place{"origins-at-1e4", 1e4, 1.0}, Place{"origins-at-1e5", 1e5, 1.0},
        Place{"origins-small", 0.0, 1e-5}, Place{"origins-large", 0.0, 1e5}}) {
    add(place.id,
        fmt::format("rays from a surface of size {:g} at {:g} hit it again, or jump over the next",
                    place.scale, place.offset),
        "convex mesh: outwards free, inwards a hit",
        [place](const CaseSize& size) { return convex(place.offset, place.scale, size); });
  }
  add("thin-gap", "a ray from one sheet jumps over the next one just above it",
      "gaps from 2^8 steps of a double on are seen", [] { return thin_gap(16.5); });
}

}  // namespace marti::studies::stability
