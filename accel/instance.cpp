#include "accel/instance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <glm/matrix.hpp>

#include "accel/triangles.h"
#include "sim/error.h"

namespace marti::accel {

Instance::Instance(const scenes::InstancePlace& place, const scenes::Bounds& mesh_box, std::uint32_t first)
    : mesh_(place.mesh), first_(first) {
  if (const std::string fault = scenes::why_not_kept(place); !fault.empty()) {
    throw sim::UserError("an instance cannot be kept: " + fault);
  }
  inverse_ = glm::inverse(place.linear);
  stretch_ = scenes::stretch_of(place.linear);
  // Row by row the least and the largest sum that corners of the box have.
  box_.lo = place.shift;
  box_.hi = place.shift;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double at_lo = place.linear[column][row] * mesh_box.lo[column];
      const double at_hi = place.linear[column][row] * mesh_box.hi[column];
      box_.lo[row] += std::min(at_lo, at_hi);
      box_.hi[row] += std::max(at_lo, at_hi);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(box_.lo[axis]) <= largest_coordinate && std::abs(box_.hi[axis]) <= largest_coordinate)) {
      throw sim::UserError("an instance reaches beyond 2^300");
    }
  }
  mesh_center_ = 0.5 * mesh_box.lo + 0.5 * mesh_box.hi;
  center_ = place.of(mesh_center_);
}

}  // namespace marti::accel
