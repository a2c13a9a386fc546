#include "scenes/instance.h"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

#include "scenes/vertex_values.h"

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
  return unit_or_zero(normal_transform(linear) * normal);
}

bool InstancePlace::mirrors() const { return is_mirroring(linear); }

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
