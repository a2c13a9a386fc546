#include "studies/stability/moved_scene.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>
#include <glm/geometric.hpp>

#include "accel/brute_force.h"
#include "accel/precision.h"
#include "sim/error.h"
#include "studies/stability/flat_triangle.h"

namespace marti::studies::stability {

namespace {

using accel::Hit;
using accel::Ray;

// The largest side of the scene's box; 1 for a scene that is a point.
double size_of(const Subject& subject) {
  const double size = largest(subject.triangles->bounds().hi - subject.triangles->bounds().lo);
  return size > 0.0 ? size : 1.0;
}

std::uint64_t agreeing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::uint64_t equal = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    equal += a[k] == b[k] ? 1U : 0U;
  }
  return equal;
}

}  // namespace

bool same_hit(const Hit& a, const Hit& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return a.primitive == b.primitive && same(a.t, b.t) && same(a.u, b.u) && same(a.v, b.v) && same(a.w, b.w);
}

Tally tally_of(const std::vector<Ray>& rays, const std::function<bool(const Ray&)>& good) {
  std::atomic<std::uint64_t> wrong = 0;
  tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t k) { wrong += good(rays[k]) ? 0U : 1U; });
  return {wrong, rays.size()};
}

Hit closest(const accel::Structure& structure, const Ray& ray, bool floats) {
  return !floats ? structure.closest(ray) : accel::visit_structure(structure, [&](const auto& concrete) {
    accel::NullVisitor visitor;
    return concrete.template closest<float>(ray, visitor);
  });
}

Tally differences(const accel::Structure& structure, const std::vector<Ray>& rays, bool floats) {
  // The structure keeps its primitives alive; brute force only borrows them.
  const accel::BruteForce brute(
      std::shared_ptr<const accel::TriangleSet>(std::shared_ptr<void>(), &structure.triangles()));
  return tally_of(rays, [&](const Ray& ray) {
    accel::NullVisitor visitor;
    const Hit expected = floats ? brute.closest<float>(ray, visitor) : brute.closest(ray, visitor);
    return same_hit(expected, closest(structure, ray, floats)) &&
           (floats || structure.occluded(ray) == expected.found());
  });
}

bool within_floats(const accel::TriangleSet& triangles) {
  const accel::PrecisionNeed need = accel::precision_need(triangles);
  return need.largest < 0x1p60 && largest(triangles.bounds().hi - triangles.bounds().lo) > 0x1p-60;
}

std::optional<Moved> Moved::of(const Subject& subject, double factor, double sizes) {
  Moved moved;
  moved.offset = sizes * size_of(subject);
  scenes::Scene scene;  // without textures
  scene.triangles = subject.scene.triangles;
  scene.positions = subject.scene.positions;
  scene.quadrics = subject.scene.quadrics;
  for (glm::dvec3& p : scene.positions) {
    p = p * factor + moved.offset;
  }
  for (scenes::Quadric& quadric : scene.quadrics) {
    quadric.base = quadric.base * factor + moved.offset;
    quadric.tip = quadric.tip * factor + moved.offset;
    quadric.radius *= factor;
    quadric.tip_radius *= factor;
  }
  try {
    moved.triangles = std::make_shared<const accel::TriangleSet>(scene);
  } catch (const sim::UserError&) {
    return std::nullopt;
  }
  moved.structure =
      accel::make_structure(subject.frame.structure, moved.triangles, subject.frame.structure_options);
  return moved;
}

std::vector<Ray> rays_of(const accel::Structure& structure, std::span<const Aim> aims, std::uint32_t count) {
  RayMaker maker(structure.triangles(), structure.bounds(), 22);
  std::vector<Ray> rays;
  for (std::uint32_t k = 0; k < count; ++k) {
    rays.push_back(maker.make(aims[k % aims.size()]));
  }
  return rays;
}

tables::Table precision_table(const Subject& subject) {
  tables::Table table(
      "float_double", "Floats beside doubles: the scene moved along every axis, the same rays at it",
      {tables::real_column("moved", "1", "by how many times the scene's largest side"),
       tables::real_column("steps", "1", "floats across the scene's largest side, at its place"),
       tables::count_column("primitives", "of the scene"),
       tables::count_column("collapsed", "primitives that have no area in floats"),
       tables::count_column("low",
                            "triangles too low for floats to tell on which side of a neighbour a ray begins: "
                            "of closed bodies that have none, none escapes"),
       tables::count_column("low_in_doubles", "triangles too low for doubles to tell it"),
       tables::count_column("rays", "traced at each place"),
       tables::count_column("hits", "of these, hit the scene where it is, in doubles"),
       tables::real_column("float_agrees", "fraction", "rays that hit the same in floats as in doubles"),
       tables::real_column("double_agrees", "fraction", "rays that hit the same in doubles as where it is"),
       tables::text_column("advice", "what the program says of the scene")});
  constexpr std::array aims{Aim::random, Aim::inside};
  std::vector<std::uint32_t> here;
  for (const double place : places) {
    const std::optional<Moved> moved = Moved::of(subject, 1.0, place);
    if (!moved) {
      continue;
    }
    std::vector<Ray> rays = rays_of(*subject.structure, aims, subject.rays);
    for (Ray& ray : rays) {
      ray.origin += glm::dvec3(moved->offset);
    }
    const bool floats = within_floats(*moved->triangles);
    std::vector<std::uint32_t> in_doubles(rays.size());
    std::vector<std::uint32_t> in_floats(rays.size());
    tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t k) {
      in_doubles[k] = moved->structure->closest(rays[k]).primitive;
      in_floats[k] = floats ? closest(*moved->structure, rays[k], true).primitive : accel::no_primitive;
    });
    if (here.empty()) {
      here = in_doubles;
    }
    const accel::PrecisionNeed need = accel::precision_need(*moved->triangles);
    const auto share = [&](std::uint64_t part) {
      return static_cast<double>(part) / static_cast<double>(rays.size());
    };
    tables::Cell float_share;
    if (floats) {
      float_share = share(agreeing(in_floats, in_doubles));
    }
    table.add_row({place, need.steps, need.primitives, need.collapsed,
                   low_triangles(*moved->triangles, float()), low_triangles(*moved->triangles, double()),
                   rays.size(),
                   static_cast<std::uint64_t>(std::ranges::count_if(
                       here, [](std::uint32_t id) { return id != accel::no_primitive; })),
                   float_share, share(agreeing(in_doubles, here)),
                   need.wants_double() ? "doubles" : "floats would do"});
  }
  return table;
}

}  // namespace marti::studies::stability
