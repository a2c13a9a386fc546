#include "studies/operations/unit_length.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "accel/structure.h"
#include "processors/cost/operation_mix.h"
#include "sim/error.h"

namespace marti::studies::operations {

namespace {

using accel::TriangleCorners;
using Points = std::vector<TriangleCorners>;

void add_point(Points& points, double x, double y, double z) {
  points.push_back({x, y, z, x, y, z, x, y, z});
}

/// The corners that make the unit cube the root box.
Points box_corners() {
  Points points;
  add_point(points, 0.0, 0.0, 0.0);
  add_point(points, 1.0, 1.0, 1.0);
  return points;
}

/// Two points in each node of the level before the last, in opposite octants: with at most one in a leaf,
/// every node is split down to `depth`.
Points filling_points(std::uint32_t depth) {
  Points points = box_corners();
  const std::uint32_t n = 1U << (depth - 2);
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        for (const double at : {0.25, 0.75}) {
          add_point(points, (x + at) / n, (y + at) / n, (z + at) / n);
        }
      }
    }
  }
  return points;
}

/// Points on a sphere, evenly along a spiral, several in each of the finest cells that it meets.
Points sphere_points(std::uint32_t depth) {
  Points points = box_corners();
  const std::uint32_t count = 16U << (2 * (depth - 1));
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::uint32_t i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    add_point(points, 0.5 + 0.45 * r * std::cos(golden * i), 0.5 + 0.45 * r * std::sin(golden * i),
              0.5 + 0.45 * z);
  }
  return points;
}

/// A ray from one side of the unit cube to another, and its length within.
struct Crossing {
  accel::Ray ray;
  double length;
};

/// Uniform in position and direction: a uniform point of the surface and a direction into the cube with a
/// probability in proportion to the cosine of its angle to the normal.
class IsotropicRays {
 public:
  Crossing next() {
    const std::uint32_t side = static_cast<std::uint32_t>(engine_() % 6);
    const int axis = static_cast<int>(side / 2);
    const bool upper = side % 2 != 0;
    const double cosine = std::sqrt(unit());
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const double turn = 2.0 * std::numbers::pi * unit();
    glm::dvec3 at;
    glm::dvec3 direction;
    at[axis] = upper ? 1.0 : 0.0;
    at[(axis + 1) % 3] = unit();
    at[(axis + 2) % 3] = unit();
    direction[axis] = upper ? -cosine : cosine;
    direction[(axis + 1) % 3] = sine * std::cos(turn);
    direction[(axis + 2) % 3] = sine * std::sin(turn);
    double length = 4.0;
    for (int a = 0; a < 3; ++a) {
      if (direction[a] != 0.0) {
        length = std::min(length, ((direction[a] > 0.0 ? 1.0 : 0.0) - at[a]) / direction[a]);
      }
    }
    return {{at - direction, direction}, std::max(length, 0.0)};
  }

 private:
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }

  std::mt19937_64 engine_{1992};
};

accel::OperationCounts walk_of(const processors::cost::MeasuredWalks& walks) {
  accel::OperationCounts sum = walks.branch;
  sum += walks.leaf;
  return sum;
}

}  // namespace

std::vector<UnitLengthRow> measure_unit_lengths(std::uint32_t deepest, std::uint32_t rays) {
  sim::ensure(deepest <= 9, "unit lengths: a full octree of more than 9 levels is not built");
  IsotropicRays maker;
  std::vector<accel::Ray> all;
  double length = 0.0;
  for (std::uint32_t k = 0; k < rays; ++k) {
    const Crossing crossing = maker.next();
    all.push_back(crossing.ray);
    length += crossing.length;
  }
  std::vector<UnitLengthRow> rows;
  for (std::uint32_t depth = 2; depth <= deepest; ++depth) {
    UnitLengthRow& row = rows.emplace_back();
    row.depth = depth;
    row.width = 1U << (depth - 1);
    row.length = length * row.width;
    accel::StructureOptions options;
    options.octree.max_objects = 1;
    options.octree.max_level = depth;
    options.grid.resolution.fill(row.width);
    options.grid.max_cells = std::uint64_t{1} << 27U;
    const auto filling = std::make_shared<const accel::TriangleSet>(filling_points(depth));
    {
      const auto octree = accel::make_structure("octree", filling, options);
      sim::ensure(octree->topology().nodes.size() == ((std::size_t{1} << (3 * depth)) - 1) / 7,
                  "unit lengths: the octree is not full");
      const processors::cost::MeasuredWalks walks = processors::cost::measure_walks(*octree, all);
      row.full_branches = walks.steps.branches;
      row.full_leaves = walks.steps.leaves;
      row.full = walk_of(walks);
    }
    {
      const auto grid = accel::make_structure("grid", filling, options);
      const processors::cost::MeasuredWalks walks = processors::cost::measure_walks(*grid, all);
      row.cells = walks.steps.leaves;
      row.grid = walk_of(walks);
    }
    const auto octree = accel::make_structure(
        "octree", std::make_shared<const accel::TriangleSet>(sphere_points(depth)), options);
    const processors::cost::MeasuredWalks walks = processors::cost::measure_walks(*octree, all);
    row.surface_branches = walks.steps.branches;
    row.surface_leaves = walks.steps.leaves;
    row.surface = walk_of(walks);
  }
  return rows;
}

}  // namespace marti::studies::operations
