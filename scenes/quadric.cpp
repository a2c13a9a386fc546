#include "scenes/quadric.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <glm/geometric.hpp>

#include "scenes/scene.h"
#include "sim/error.h"

namespace marti::scenes {

namespace {

constexpr double largest_number = 0x1p300;
constexpr double least_radius = 0x1p-300;
constexpr double flattest = 0x1p-20;
constexpr double longest = 0x1p40;

[[noreturn]] void refuse(const std::string& name, const char* why, double value) {
  std::ostringstream message;
  message << name << why << value;
  throw sim::UserError(message.str());
}

}  // namespace

void check_quadric(const Quadric& quadric, const std::string& name) {
  const bool sphere = quadric.kind == QuadricKind::sphere;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double x : {quadric.base[axis], sphere ? 0.0 : quadric.tip[axis]}) {
      if (!(std::abs(x) <= largest_number)) {
        refuse(name, " has a coordinate that is not a number of magnitude up to 2^300: ", x);
      }
    }
  }
  const double second = sphere ? quadric.radius : quadric.end_radius();
  for (const double radius : {quadric.radius, second}) {
    if (!(radius >= 0.0 && radius <= largest_number)) {
      refuse(name, " has a radius that is not a number from 0 to 2^300: ", radius);
    }
  }
  const double radius = std::max(quadric.radius, second);
  if (!(radius >= least_radius)) {
    refuse(name, " has no radius, or one below 2^-300: ", radius);
  }
  if (sphere) {
    return;
  }
  const glm::dvec3 axis = quadric.tip - quadric.base;
  const double height = std::hypot(axis.x, axis.y, axis.z);
  if (!(height >= flattest * radius && height >= least_radius)) {
    refuse(name, " has its two ends in one place, or closer than 2^-20 of its radius: ", height);
  }
  if (!(height <= longest * radius)) {
    refuse(name, " is longer than 2^40 of its radius: ", height);
  }
}

Bounds bounds_of(const Quadric& quadric) {
  Bounds bounds;
  if (quadric.kind == QuadricKind::sphere) {
    bounds.include(quadric.base - quadric.radius);
    bounds.include(quadric.base + quadric.radius);
    return bounds;
  }
  const glm::dvec3 axis = quadric.tip - quadric.base;
  const double height = std::hypot(axis.x, axis.y, axis.z);
  // How far a disc of radius 1 across the axis extends along each coordinate: the sine of the angle between
  // the coordinate and the disc's axis, from the other two components, because 1 - cos^2 would cancel.
  const glm::dvec3 reach(std::hypot(axis.y, axis.z) / height, std::hypot(axis.z, axis.x) / height,
                         std::hypot(axis.x, axis.y) / height);
  bounds.include(quadric.base - quadric.radius * reach);
  bounds.include(quadric.base + quadric.radius * reach);
  bounds.include(quadric.tip - quadric.end_radius() * reach);
  bounds.include(quadric.tip + quadric.end_radius() * reach);
  return bounds;
}

}  // namespace marti::scenes
