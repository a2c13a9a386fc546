// Cases of scenes: empty, flat, coincident, of all sizes at once.
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "scenes/procedural.h"
#include "studies/stability/geometry_oracles.h"

namespace marti::studies::stability {

namespace {

using accel::Ray;
using accel::TriangleSet;

constexpr const char* same_as_brute_force = "brute force, bit for bit, in every structure";

/// All triangles in the plane where `axis` is `height`.
CaseOutcome flat(int axis, const CaseSize& size) {
  Random random(31);
  std::vector<accel::TriangleCorners> sheet;
  for (int k = 0; k < 300; ++k) {
    std::array<glm::dvec3, 3> p;
    p[0] = random.in_box(glm::dvec3(-1.0), glm::dvec3(1.0));
    p[1] = p[0] + 0.3 * random.direction();
    p[2] = p[0] + 0.3 * random.direction();
    for (glm::dvec3& corner : p) {
      corner[axis] = 0.25;
    }
    sheet.push_back(corners(p[0], p[1], p[2]));
  }
  return none_wrong(disagreements(std::move(sheet), size.rays, 32), "rays differ");
}

CaseOutcome few(std::vector<accel::TriangleCorners> triangles, const CaseSize& size) {
  return none_wrong(disagreements(std::move(triangles), size.rays, 33), "rays differ");
}

CaseOutcome empty(const CaseSize& size) {
  const auto triangles = std::make_shared<const TriangleSet>();
  Random random(34);
  Tally tally;
  for (const auto& structure : build_structures(triangles)) {
    for (std::uint32_t k = 0; k < size.rays; ++k) {
      const Ray ray{random.direction(), random.direction()};
      tally.add(!structure->closest(ray).found() && !structure->occluded(ray));
    }
  }
  return none_wrong(tally, "rays hit something");
}

/// So many copies of one triangle: no plane separates them.
CaseOutcome coincident(const CaseSize& size) {
  constexpr std::size_t copies = 10'000;
  const std::vector<accel::TriangleCorners> all(copies,
                                                corners({0.1, 0.2, 0.3}, {0.9, 0.3, 0.2}, {0.4, 0.8, 0.9}));
  const auto triangles = std::make_shared<const TriangleSet>(all);
  std::size_t most_nodes = 0;
  std::size_t most_entries = 0;
  Tally tally;
  Random random(35);
  std::vector<std::unique_ptr<accel::Structure>> structures;
  accel::StructureOptions options;
  options.grid.resolution = {8, 8, 8};
  for (const std::string_view kind : {"octree", "bsp", "grid", "bvh"}) {
    structures.push_back(accel::make_structure(kind, triangles, options));
  }
  structures.push_back(accel::make_lazy_octree(triangles));
  const auto one_of_them = accel::make_structure(
      "none", std::make_shared<const TriangleSet>(std::vector<accel::TriangleCorners>{all.front()}));
  for (const auto& structure : structures) {
    if (structure->kind() == accel::Octree::kind_name || structure->kind() == accel::Bsp::kind_name) {
      most_nodes = std::max(most_nodes, structure->topology().nodes.size());
      most_entries = std::max(most_entries, structure->topology().entries.size());
    }
    for (std::uint32_t k = 0; k < size.rays / 200 + 10; ++k) {
      Ray ray{2.0 * random.direction(), {}};
      ray.direction = glm::dvec3(0.45, 0.42, 0.45) + 0.1 * random.direction() - ray.origin;
      const accel::Hit hit = structure->closest(ray);
      const accel::Hit alone = one_of_them->closest(ray);
      tally.add(same_hit(hit, alone));  // of equal hits, that of the lowest id
    }
  }
  CaseOutcome outcome = none_wrong(tally, "hits not of the lowest id");
  // Sixteen entries a triangle are more than a tree should spend on what it cannot separate.
  outcome.value += most_entries > 16 * copies ? 1.0 : 0.0;
  outcome.figure += fmt::format("; trees of at most {} nodes, {} entries", tables::grouped(most_nodes),
                                tables::grouped(most_entries));
  return outcome;
}

std::vector<accel::TriangleCorners> teapot_corners() {
  const TriangleSet teapot(scenes::make_procedural("teapot:4"));
  std::vector<accel::TriangleCorners> all;
  for (std::uint32_t id = 0; id < teapot.triangles(); ++id) {
    all.push_back(teapot[id]);
  }
  return all;
}

CaseOutcome stadium(const CaseSize& size) {
  std::vector<accel::TriangleCorners> all = teapot_corners();
  const std::size_t teapot = all.size();
  const double far = 5e5;  // 1e5 teapots across
  all.push_back(corners({-far, -far, 0}, {far, -far, 0}, {far, far, 0}));
  all.push_back(corners({far, far, 0}, {-far, far, 0}, {-far, -far, 0}));
  const auto triangles = std::make_shared<const TriangleSet>(std::move(all));
  const accel::BruteForce brute(triangles);
  auto structures = build_structures(triangles, false);
  accel::StructureOptions deepest;
  deepest.octree.max_level = 21;
  structures.push_back(accel::make_structure("octree", triangles, deepest));
  Random random(36);
  Tally tally;
  std::uint64_t hits = 0;
  for (std::uint32_t k = 0; k < size.rays / 4 + 1; ++k) {
    Ray ray{10.0 * random.direction() + glm::dvec3(0, 0, 11), {}};
    ray.direction = triangles->corner(random.below(static_cast<std::uint32_t>(teapot)), random.below(3)) +
                    0.05 * random.direction() - ray.origin;
    accel::NullVisitor visitor;
    const accel::Hit expected = brute.closest(ray, visitor);
    hits += expected.found() && expected.primitive < teapot ? 1U : 0U;
    bool good = true;
    for (const auto& structure : structures) {
      good = good && same_hit(expected, structure->closest(ray));
    }
    tally.add(good);
  }
  std::uint64_t overfull = 0;
  const auto* octree = dynamic_cast<const accel::StructureOf<accel::Octree>*>(structures.front().get());
  for (const accel::LevelStatistics& level : octree->concrete().levels()) {
    overfull += level.overfull_leaves;
  }
  CaseOutcome outcome = none_wrong(tally, "rays differ");
  outcome.figure += fmt::format("; {} hit the teapot; {} leaves of the octree of 12 levels over the limit",
                                tables::grouped(hits), tables::grouped(overfull));
  return outcome;
}

}  // namespace

void add_scene_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::geometry);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    add("flat-" + name, "a scene without extent along " + name + " has cells without volume",
        same_as_brute_force, [axis](const CaseSize& size) { return flat(axis, size); });
  }
  add("huge-among-small", "two triangles 400 scenes long crowd all others into a few cells",
      same_as_brute_force, [](const CaseSize& size) { return few(hostile_soup(0.0, 37, true), size); });
  add("empty-scene", "a scene of no triangles has no box", "no ray hits, nothing breaks", empty);
  add("one-triangle", "a structure over a single triangle", same_as_brute_force, [](const CaseSize& size) {
    return few({corners({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}, size);
  });
  add("one-degenerate", "a scene of one triangle without area", same_as_brute_force,
      [](const CaseSize& size) {
        return few({corners({0, 0, 0}, {1, 1, 1}, {2, 2, 2})}, size);
      });
  add("all-vertices-equal", "200 triangles in one point: the scene has no size at all", same_as_brute_force,
      [](const CaseSize& size) {
        const glm::dvec3 p(0.3, -0.7, 0.2);
        return few(std::vector<accel::TriangleCorners>(200, corners(p, p, p)), size);
      });
  add("coincident", "10,000 equal triangles are split until memory is gone",
      "trees stop, at most 16 entries a triangle; the lowest id is hit", coincident);
  add("teapot-in-stadium", "a ground 1e5 teapots across: all cells are spent on nothing", same_as_brute_force,
      stadium);
}

}  // namespace marti::studies::stability
