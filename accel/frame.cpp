#include "accel/frame.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sim/error.h"

namespace marti::accel {

namespace {

// By how many delta the root reaches beyond the triangles. It is more than the 2 that hits need, so that
// corners on a dyadic plane of the tight box, common in models, lie clearly on one side of the moved plane
// instead of within delta of it, and their triangles are not listed twice. It is not a power of two, so that
// the flat side of a flat scene lies in no plane of any level.
constexpr double root_margin = 192.0;

void check_enclosed(const scenes::Bounds& box) {
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(box.lo[a]) <= largest_coordinate && std::abs(box.hi[a]) <= largest_coordinate &&
          box.lo[a] <= box.hi[a])) {
      std::ostringstream message;
      message << "the box that a structure's root is to enclose reaches from " << box.lo[a] << " to "
              << box.hi[a] << " along "
              << "xyz"[a] << "; both must be numbers of magnitude up to 2^300, the "
              << "first no larger than the second";
      throw sim::UserError(message.str());
    }
  }
}

/// Whether a box was given: the default box has lo > hi on every axis.
bool given(const scenes::Bounds& box) {
  return !(box.lo.x > box.hi.x && box.lo.y > box.hi.y && box.lo.z > box.hi.z);
}

}  // namespace

RootFrame make_frame(const TriangleSet& triangles, const scenes::Bounds& enclose) {
  scenes::Bounds tight = triangles.bounds();
  if (given(enclose)) {
    check_enclosed(enclose);
    if (!tight.empty()) {
      tight.include(enclose.lo);
      tight.include(enclose.hi);
    }
  }
  return make_frame(tight, usual_reach);
}

RootFrame make_frame(const scenes::Bounds& tight, double reach) {
  RootFrame frame;
  if (tight.empty()) {
    return frame;
  }
  const glm::dvec3 extent = tight.hi - tight.lo;
  const double diagonal = std::hypot(extent.x, extent.y, extent.z);
  double largest = 0.0;
  for (int a = 0; a < 3; ++a) {
    largest = std::max({largest, std::abs(tight.lo[a]), std::abs(tight.hi[a])});
  }
  frame.delta = 0x1p-40 * (reach / usual_reach) * diagonal + 8.0 * 0x1p-52 * largest;
  frame.box.lo = tight.lo - root_margin * frame.delta;
  frame.box.hi = tight.hi + root_margin * frame.delta;
  for (int a = 0; a < 3; ++a) {
    frame.box.hi[a] = std::max(frame.box.hi[a], frame.box.lo[a] + 0x1p-12 * diagonal);
  }
  frame.center = 0.5 * frame.box.lo + 0.5 * frame.box.hi;
  // 64 on each axis makes the distance less than 128 diagonals.
  frame.far = reach * diagonal;
  frame.largest_inverse = 0x1p1014 / std::max(1.0, diagonal);
  return frame;
}

void require_range(std::string_view structure, std::string_view option, std::uint64_t value, std::uint64_t lo,
                   std::uint64_t hi) {
  if (value < lo || value > hi) {
    std::ostringstream message;
    message << structure << ": " << option << " is " << value << ", must be from " << lo << " to " << hi;
    throw sim::UserError(message.str());
  }
}

}  // namespace marti::accel
