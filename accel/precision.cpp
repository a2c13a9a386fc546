#include "accel/precision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include <glm/vec3.hpp>

namespace marti::accel {

namespace {

constexpr double enough_steps = 65536.0;
constexpr double longest_edge = 0x1p62;

/// The number rounded to a float; infinite beyond the largest float, as in the kernel. Not inlined, because
/// g++ 12 turns three such conversions into one vector and omits the rounding.
[[gnu::noinline]] double rounded(double x) { return static_cast<double>(static_cast<float>(x)); }

double longest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

void look_at_triangle(const TriangleSet& set, std::uint32_t id, PrecisionNeed& need) {
  const std::array<glm::dvec3, 3> p{set.corner(id, 0), set.corner(id, 1), set.corner(id, 2)};
  std::array<glm::dvec3, 3> r;
  for (std::size_t k = 0; k < 3; ++k) {
    r[k] = {rounded(p[k].x), rounded(p[k].y), rounded(p[k].z)};
  }
  if (!scenes::has_no_area(p[0], p[1], p[2]) && scenes::has_no_area(r[0], r[1], r[2])) {
    ++need.collapsed;
  }
  const double edge = std::max({longest(p[1] - p[0]), longest(p[2] - p[0]), longest(p[2] - p[1])});
  need.out_of_range += edge > longest_edge || (edge > 0.0 && edge < 1.0 / longest_edge) ? 1U : 0U;
}

void look_at_quadric(const QuadricShape& shape, PrecisionNeed& need) {
  double extent = 0.0;
  bool collapses = false;
  for (std::size_t a = 0; a < 3; ++a) {
    extent = std::max(extent, shape.hi[a] - shape.lo[a]);
    collapses = collapses || (shape.lo[a] < shape.hi[a] && rounded(shape.lo[a]) == rounded(shape.hi[a]));
  }
  need.collapsed += collapses ? 1U : 0U;
  need.out_of_range += extent > longest_edge || extent < 1.0 / longest_edge ? 1U : 0U;
}

/// The distance of neighbouring floats at x; infinite beyond their range.
double spacing_at(double x) {
  if (!(x <= static_cast<double>(std::numeric_limits<float>::max()))) {
    return std::numeric_limits<double>::infinity();
  }
  const float at = std::max(static_cast<float>(x), std::numeric_limits<float>::denorm_min());
  return static_cast<double>(at) - static_cast<double>(std::nextafter(at, 0.0F));
}

}  // namespace

bool PrecisionNeed::wants_double() const {
  return collapsed > 0 || out_of_range > 0 || std::isinf(spacing) || (steps > 0.0 && steps < enough_steps);
}

PrecisionNeed precision_need(const TriangleSet& set) {
  PrecisionNeed need;
  need.primitives = set.size();
  for (std::uint32_t id = 0; id < set.size(); ++id) {
    if (id < set.triangles()) {
      look_at_triangle(set, id, need);
    } else {
      look_at_quadric(set.quadric(id), need);
    }
  }
  const scenes::Bounds& box = set.bounds();
  if (!box.empty()) {
    need.largest = std::max(longest(box.lo), longest(box.hi));
    need.spacing = spacing_at(need.largest);
    const double size = longest(box.hi - box.lo);
    need.steps = size > 0.0 ? size / need.spacing : 0.0;
  }
  return need;
}

std::string describe_need(const PrecisionNeed& need) {
  if (!need.wants_double()) {
    return {};
  }
  std::ostringstream out;
  out << "this scene needs doubles, which marti computes in: its coordinates reach " << need.largest;
  if (need.steps > 0.0) {
    out << ", where floats are " << need.spacing << " apart, " << need.steps << " steps across the scene";
  }
  if (need.collapsed > 0) {
    out << "; " << need.collapsed << " of " << need.primitives << " primitives would collapse in floats";
  }
  if (need.out_of_range > 0) {
    out << "; " << need.out_of_range << " of " << need.primitives
        << " are so large or small that products of their lengths leave a float's range";
  }
  return out.str();
}

}  // namespace marti::accel
