// Cases of rays: what the structure of the user's scene finds, and what its triangles let through.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "processors/program/shading.h"
#include "studies/stability/flat_triangle.h"
#include "studies/stability/hostile_rays.h"
#include "studies/stability/mesh_edges.h"
#include "studies/stability/moved_scene.h"
#include "studies/tables/text_units.h"

namespace marti::studies::stability {

namespace {

using accel::Ray;

/// The scene elsewhere or of another size, and rays of all kinds there.
CaseOutcome moved(const Subject& subject, double factor, double sizes) {
  const std::optional<Moved> other = Moved::of(subject, factor, sizes);
  return other
             ? none_wrong(differences(*other->structure, rays_of(*other->structure, all_aims, subject.rays)),
                          "rays differ")
             : not_tried("coordinates would leave the range that is computed with");
}

CaseOutcome cracks(const Subject& subject, bool floats) {
  const MeshEdges mesh(*subject.triangles);
  const std::vector<Ray> rays = mesh.rays_at_edges(subject.rays, floats ? 0x1p-24 : 0x1p-53, 41);
  if (rays.empty()) {
    return not_tried("no two triangles share an edge");
  }
  if (floats && !within_floats(*subject.triangles)) {
    return not_tried("lengths leave a float's range");
  }
  const Tally tally =
      tally_of(rays, [&](const Ray& ray) { return closest(*subject.structure, ray, floats).found(); });
  CaseOutcome outcome = none_wrong(tally, "rays passed between triangles");
  outcome.figure += fmt::format("; {} of {} edges have one triangle only", tables::grouped(mesh.open_edges()),
                                tables::grouped(mesh.edges()));
  return outcome;
}

/// Rays that begin on edges and corners, from where processors::program::leave puts them. `leave` promises to
/// tell the sides of triangles that are high enough (processors::program::sure_height) and meet at more than
/// some 8 degrees.
template <class Real>
CaseOutcome leaving(const Subject& subject) {
  using Vec = processors::program::Vec3<Real>;
  constexpr bool floats = std::is_same_v<Real, float>;
  constexpr double rounding = floats ? 0x1p-24 : 0x1p-53;
  constexpr double eight_degrees = 0.14;
  const accel::TriangleSet& triangles = *subject.triangles;
  if (floats && !within_floats(triangles)) {
    return not_tried("lengths leave a float's range");
  }
  const double reach = largest(triangles.bounds().hi - triangles.bounds().lo);
  const MeshEdges mesh(triangles);
  Random random(51);
  Tally escaped;
  Tally stopped;
  for (std::uint64_t trial = 0; triangles.triangles() > 0 && trial < std::uint64_t{10} * subject.rays;
       ++trial) {
    const std::uint32_t id = random.below(triangles.triangles());
    const unsigned first = random.below(3);
    const glm::dvec3 direction = random.direction();
    const double along = trial % 2 == 0 ? 0.0 : random.unit();
    const std::optional<std::uint32_t> other = mesh.neighbour(id, first);
    if (!other) {
      continue;
    }
    const FlatTriangle own(triangles, id, reach, Real());
    const FlatTriangle next(triangles, *other, reach, Real());
    const double numbers = reach + largest(own.corners[first]);
    const double rise = glm::dot(own.normal, direction);
    const double turn = glm::dot(next.normal, direction);
    if (!own.is_sure() || !next.is_sure() || std::min(std::abs(rise), std::abs(turn)) < eight_degrees) {
      continue;  // so low that rounding decides, or seen edge-on
    }
    Real weights[3] = {};
    weights[first] = static_cast<Real>(1.0 - along);
    weights[(first + 1) % 3] = static_cast<Real>(along);
    const Vec way(direction);
    const auto surface = processors::program::surface_at(subject.scene, id, weights, -way, reach);
    const Vec origin = processors::program::leave(surface, way);
    Ray ray{{origin.x, origin.y, origin.z}, {way.x, way.y, way.z}};
    ray.t_min = std::numeric_limits<Real>::denorm_min();
    // Whether the neighbour lies on the ray's side of the plane that it leaves, and the ray goes behind it.
    const double fold = own.over(next.corners[mesh.third(id, first, *other)]) * (rise > 0.0 ? 1.0 : -1.0);
    const bool behind = turn * next.over(own.corners[(first + 2) % 3]) < 0.0;
    if (fold <= 0.0 || !behind) {
      const std::uint32_t hit = closest(*subject.structure, ray, floats).primitive;
      stopped.add(hit != id && hit != *other);
      continue;
    }
    const double t = -next.over(ray.origin) / turn;
    const double sure = 0x1p8 * rounding * numbers;
    if (t > 0.0 && next.inside(ray.origin + t * direction) > sure) {
      ray.t_max = t + sure;
      escaped.add(closest(*subject.structure, ray, floats).found());
    }
  }
  if (stopped.of == 0) {
    return not_tried(low_triangles(triangles, Real()) == triangles.triangles()
                         ? "all triangles are so low that rounding decides"
                         : "no two triangles share an edge");
  }
  CaseOutcome outcome = none_wrong(stopped, "rays were stopped by what they began on");
  outcome.objection += static_cast<double>(escaped.wrong);
  outcome.figure += fmt::format("; {} of {} escaped through its neighbour", tables::grouped(escaped.wrong),
                                tables::grouped(escaped.of));
  return outcome;
}

}  // namespace

void add_ray_cases(std::vector<StabilityCase>& cases) {
  const auto add = [&](std::string id, std::string risk, std::string oracle, auto run) {
    cases.push_back({std::move(id), CaseGroup::scene, std::move(risk), std::move(oracle), std::move(run)});
  };
  const std::string same = "brute force: primitive, t and weights bit for bit";
  struct Rays {
    Aim aim;
    const char* id;
    const char* risk;
  };
  for (const Rays& rays : {
           Rays{Aim::random, "rays-generic", "the structure loses a hit"},
           Rays{Aim::inside, "rays-inside", "an origin inside the structure begins in the wrong cell"},
           Rays{Aim::axis, "rays-axis",
                "axis-parallel rays in cell planes divide 0 by 0; -0.0 turns the octant"},
           Rays{Aim::cell_face, "rays-in-faces", "rays that lie in a cell's face are in neither neighbour"},
           Rays{Aim::vertex, "rays-at-corners", "rays at triangles' corners slip between cells"},
           Rays{Aim::edge, "rays-at-edges", "rays at triangles' edges slip between cells"},
           Rays{Aim::grazing, "rays-grazing", "rays in a triangle's plane hit it here and miss it there"},
           Rays{Aim::corner, "rays-at-cell-corners", "a camera on a corner of a cell is in eight cells"},
           Rays{Aim::denormal, "rays-denormal",
                "components as small as they can be overflow their reciprocals"},
           Rays{Aim::far, "rays-from-afar", "origins 1e2 to 1e9 scenes away round away the cells"},
       }) {
    add(rays.id, rays.risk, same, [aim = rays.aim](const Subject& subject) {
      const std::vector<Ray> all = rays_of(*subject.structure, std::span(&aim, 1), subject.rays);
      return none_wrong(differences(*subject.structure, all), "rays differ");
    });
  }
  for (const double factor : {1e-18, 1e-9, 1e9, 1e18}) {
    add(fmt::format("scaled-{:g}", factor),
        fmt::format("all lengths times {:g}: products leave their range", factor), same,
        [factor](const Subject& subject) { return moved(subject, factor, 0.0); });
  }
  for (const double place : std::span(places).subspan(1)) {
    add(fmt::format("moved-{:g}", place),
        fmt::format("the scene moved by {:g} times its size: cells are rounded away", place), same,
        [place](const Subject& subject) { return moved(subject, 1.0, place); });
  }
  add("floats", "the structure loses hits that floats have", "brute force in floats, bit for bit",
      [](const Subject& subject) {
        constexpr std::array aims{Aim::random, Aim::inside, Aim::axis, Aim::edge, Aim::vertex, Aim::grazing};
        const std::vector<Ray> rays = rays_of(*subject.structure, aims, subject.rays);
        return within_floats(*subject.triangles)
                   ? none_wrong(differences(*subject.structure, rays, true), "rays differ")
                   : not_tried("lengths leave a float's range");
      });
  add("cracks", "rays pass between triangles that meet", "where two triangles share an edge something is hit",
      [](const Subject& subject) { return cracks(subject, false); });
  add("cracks-in-floats", "the same, when hits are computed in floats",
      "where triangles look 256 roundings wide something is hit",
      [](const Subject& subject) { return cracks(subject, true); });
  add("leaving", "rays that begin on an edge or corner escape, or are stopped by what they began on",
      "triangles that rise before them by 8 degrees are hit, others not", leaving<double>);
  add("leaving-in-floats", "the same in floats", "the same, 256 roundings inside", leaving<float>);
}

}  // namespace marti::studies::stability
