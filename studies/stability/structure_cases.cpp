// Cases of rays: whatever their direction and origin, every structure gives brute force's hits.
#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "accel/mailbox.h"
#include "studies/stability/geometry_oracles.h"
#include "studies/stability/kernel_check.h"

namespace marti::studies::stability {

namespace {

using accel::Hit;
using accel::Ray;
using accel::TriangleSet;

constexpr const char* same_in_12_structures = "brute force: id, t and weights bit for bit, in 12 structures";

/// One class of rays at the same hostile triangles.
CaseOutcome rays_of(Aim aim, const CaseSize& size) {
  const auto triangles = std::make_shared<const TriangleSet>(hostile_soup(0.0, 21));
  const accel::BruteForce brute(triangles);
  const auto structures = build_structures(triangles);
  return none_wrong(
      disagreements(*triangles, tracer_of(brute), structures, structures[0]->bounds(), aim, size.rays, 22),
      "rays differ");
}

CaseOutcome moved_and_scaled(double offset, double scale, const CaseSize& size) {
  std::vector<accel::TriangleCorners> soup = hostile_soup(offset, 23);
  for (accel::TriangleCorners& triangle : soup) {
    for (double& x : triangle) {
      x *= scale;
    }
  }
  return none_wrong(disagreements(std::move(soup), size.rays, 24), "rays differ");
}

CaseOutcome mailboxes(const CaseSize& size) {
  const auto triangles = std::make_shared<const TriangleSet>(hostile_soup(0.0, 25, true));
  Tally tally;
  std::uint64_t with_tests = 0;
  std::uint64_t without_tests = 0;
  for (const auto& structure : build_structures(triangles)) {
    accel::visit_structure(*structure, [&](const auto& concrete) {
      RayMaker maker(*triangles, structure->bounds(), 26);
      accel::Mailboxed<TestCounter> with;
      with.prepare(triangles->size());
      for (std::uint32_t k = 0; k < size.rays; ++k) {
        const Ray ray = maker.make(all_aims[k % all_aims.size()]);
        TestCounter without;
        with.tests = 0;
        const Hit expected = concrete.closest(ray, without);
        const bool same = same_hit(expected, concrete.closest(ray, with));
        tally.add(same && with.tests <= without.tests);
        with_tests += with.tests;
        without_tests += without.tests;
      }
    });
  }
  CaseOutcome outcome = none_wrong(tally, "rays differ");
  outcome.figure +=
      fmt::format("; {} tests instead of {}", tables::grouped(with_tests), tables::grouped(without_tests));
  return outcome;
}

}  // namespace

void add_structure_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::geometry);
  struct Rays {
    Aim aim;
    const char* id;
    const char* risk;
  };
  for (const Rays& rays : {
           Rays{Aim::random, "rays-generic", "a structure loses a hit of needles, slivers or a crowd"},
           Rays{Aim::inside, "rays-inside", "an origin inside a structure begins in the wrong cell"},
           Rays{Aim::axis, "rays-axis",
                "axis-parallel rays in cell planes divide 0 by 0; -0.0 turns the octant"},
           Rays{Aim::cell_face, "rays-in-faces", "rays that lie in a cell's face are in neither neighbour"},
           Rays{Aim::vertex, "rays-at-corners", "rays at triangles' corners slip between cells or triangles"},
           Rays{Aim::edge, "rays-at-edges", "rays at triangles' edges slip between cells or triangles"},
           Rays{Aim::corner, "rays-at-cell-corners", "a camera on a corner of the octree is in eight cells"},
           Rays{Aim::denormal, "rays-denormal",
                "denormal components overflow their reciprocals; lengths from 2^-900 to 2^700"},
           Rays{Aim::far, "rays-from-afar", "origins 1e2 to 1e9 scenes away round away the cells"},
       }) {
    add(rays.id, rays.risk, same_in_12_structures,
        [aim = rays.aim](const CaseSize& size) { return rays_of(aim, size); });
  }
  struct Place {
    const char* id;
    double offset;
    double scale;
  };
  for (const Place& place :
       {Place{"offset-1e3", 1e3, 1.0}, Place{"offset-1e6", 1e6, 1.0}, Place{"offset-1e9", 1e9, 1.0},
        Place{"scale-1e-18", 0.0, 1e-18}, Place{"scale-1e-9", 0.0, 1e-9}, Place{"scale-1e9", 0.0, 1e9},
        Place{"scale-1e18", 0.0, 1e18}}) {
    add(place.id,
        place.offset == 0.0
            ? fmt::format("hostile triangles times {:g}: products leave their range", place.scale)
            : fmt::format("hostile triangles at {:g}: cells are rounded away", place.offset),
        same_in_12_structures,
        [place](const CaseSize& size) { return moved_and_scaled(place.offset, place.scale, size); });
  }
  add("mailboxes", "a primitive that is left out because it was tested is lost",
      "same hits with and without, and no more tests", mailboxes);
}

}  // namespace marti::studies::stability
