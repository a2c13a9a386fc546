#include "studies/stability/precision_table.h"

#include <memory>
#include <utility>

#include <fmt/format.h>

#include "accel/octree.h"
#include "scenes/procedural.h"
#include "studies/stability/hostile.h"
#include "studies/stability/stability_case.h"

namespace marti::studies::stability {

namespace {

using accel::Ray;

std::vector<Ray> rays_at(const accel::TriangleSet& set, std::uint32_t count) {
  Random random(95);
  const scenes::Bounds& box = set.bounds();
  const glm::dvec3 center = 0.5 * (box.lo + box.hi);
  const double size = glm::length(box.hi - box.lo);
  std::vector<Ray> rays;
  for (std::uint32_t k = 0; k < count; ++k) {
    Ray ray{center + size * random.direction(), {}};
    const std::uint32_t id = random.below(set.triangles());
    const glm::dvec3 a = set.corner(id, 0);
    const double u = random.unit();
    const double v = random.unit();
    const glm::dvec3 on = a + u * ((set.corner(id, 1) - a) + v * (set.corner(id, 2) - set.corner(id, 1)));
    ray.direction = (k % 2 == 0 ? on : random.in_box(box.lo, box.hi)) - ray.origin;
    rays.push_back(ray);
  }
  return rays;
}

double share(std::uint64_t part, std::uint64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(of);
}

}  // namespace

std::vector<PrecisionRow> compare_precisions(std::uint32_t rays, bool floats) {
  const scenes::Scene teapot = scenes::make_procedural("teapot:4");
  const std::vector<Ray> all = rays_at(accel::TriangleSet(teapot), rays);
  std::vector<std::uint32_t> at_origin;
  std::vector<PrecisionRow> rows;
  for (const double offset : {0.0, 1e3, 1e6, 1e9}) {
    scenes::Scene moved = teapot;
    for (glm::dvec3& p : moved.positions) {
      p += glm::dvec3(offset);
    }
    const auto triangles = std::make_shared<const accel::TriangleSet>(moved);
    const accel::Octree octree = accel::Octree::build(triangles);
    accel::NullVisitor visitor;
    PrecisionRow row;
    row.offset = offset;
    row.need = accel::precision_need(*triangles);
    for (std::size_t k = 0; k < all.size(); ++k) {
      Ray ray = all[k];
      ray.origin += glm::dvec3(offset);
      const std::uint32_t id = octree.closest(ray, visitor).primitive;
      if (offset == 0.0) {
        at_origin.push_back(id);
      }
      row.hits += at_origin[k] != accel::no_primitive ? 1U : 0U;
      row.double_agree += id == at_origin[k] ? 1U : 0U;
      row.float_agree += floats && octree.closest<float>(ray, visitor).primitive == id ? 1U : 0U;
      ++row.rays;
    }
    rows.push_back(row);
  }
  return rows;
}

tables::Table precision_table(const std::vector<PrecisionRow>& rows) {
  tables::Table table(
      "float_double", "Floats beside doubles: a teapot moved along every axis, the same rays at it",
      {tables::real_column("offset", "1", "the teapot is moved so far along every axis"),
       tables::real_column("steps", "1", "floats across the teapot's longest axis, at its place"),
       tables::count_column("triangles", "of the teapot"),
       tables::count_column("collapsed", "triangles that have no area in floats"),
       tables::count_column("rays", "traced at each place"),
       tables::count_column("hits", "of these, hit the teapot at the origin, in doubles"),
       tables::real_column("float_agrees", "fraction", "rays that hit the same in floats as in doubles"),
       tables::real_column("double_agrees", "fraction", "rays that hit the same in doubles as at the origin"),
       tables::text_column("advice", "what the program says of the scene")});
  for (const PrecisionRow& row : rows) {
    table.add_row({row.offset, row.need.steps, row.need.primitives, row.need.collapsed, row.rays, row.hits,
                   share(row.float_agree, row.rays), share(row.double_agree, row.rays),
                   row.need.wants_double() ? "doubles" : "floats would do"});
  }
  return table;
}

void add_precision_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::geometry);
  add("doubles-at-offsets", "a teapot moved by 1e3, 1e6 and 1e9 loses hits in doubles",
      "the ids of the teapot at the origin, all of them", [](const CaseSize& size) {
        Tally tally;
        for (const PrecisionRow& row : compare_precisions(size.rays, false)) {
          tally += {row.rays - row.double_agree, row.rays};
        }
        return none_wrong(tally, "rays differ");
      });
  add("floats-at-origin", "floats lose hits even of a scene that asks for no more",
      "ids in doubles, but for rays within rounding of an edge", [](const CaseSize& size) {
        const PrecisionRow row = compare_precisions(size.rays / 4).front();
        return error_within(1.0 - share(row.float_agree, row.rays), 1e-2, "share of rays that differ");
      });
}

}  // namespace marti::studies::stability
