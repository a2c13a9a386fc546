#include "scenes/instance.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace marti::scenes {

namespace {

constexpr double largest_scale = 0x1p60;
constexpr double largest_stretch = 0x1p10;

// False for NaN too.
bool within(const glm::dmat3& m, double most) {
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(m[column][row]) <= most)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

glm::dvec3 InstancePlace::normal_of(const glm::dvec3& normal) const {
  // The matrix of cofactors is the inverse transposed, times the determinant.
  const glm::dvec3 turned = glm::cross(linear[1], linear[2]) * normal.x +
                            glm::cross(linear[2], linear[0]) * normal.y +
                            glm::cross(linear[0], linear[1]) * normal.z;
  const double length = glm::length(turned);
  return length > 0.0 && std::isfinite(length) ? turned * ((mirrors() ? -1.0 : 1.0) / length)
                                               : glm::dvec3(0.0);
}

bool InstancePlace::mirrors() const { return glm::determinant(linear) < 0.0; }

double stretch_of(const glm::dmat3& linear) {
  const glm::dmat3 inverse = glm::inverse(linear);
  double largest = 0.0;
  for (int row = 0; row < 3; ++row) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum += std::abs(linear[k][row]) *
             (std::abs(inverse[0][k]) + std::abs(inverse[1][k]) + std::abs(inverse[2][k]));
    }
    largest = std::max(largest, sum);
  }
  return largest;
}

std::string why_not_kept(const InstancePlace& place) {
  if (!within(place.linear, largest_scale)) {
    return "its transform is not finite, or enlarges by more than 2^60";
  }
  if (!within(glm::inverse(place.linear), largest_scale)) {
    return "its transform is singular, or shrinks by more than 2^60";
  }
  if (!(stretch_of(place.linear) <= largest_stretch)) {
    return "its transform stretches one direction so much more than another that rays in its mesh's "
           "coordinates would be too inexact";
  }
  return {};
}

}  // namespace marti::scenes
