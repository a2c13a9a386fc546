// Real spherical harmonics up to degree 3, with the signs of 3D Gaussian splatting's trainers (P.-P. Sloan,
// "Efficient Spherical Harmonic Evaluation", JCGT 2(2), 2013, for the constants).
#pragma once

#include <array>
#include <cstddef>

namespace marti::scenes {

inline constexpr std::size_t most_harmonics = 16;

/// The (degree + 1)^2 first harmonics in the direction d, a unit vector of the scalar Real.
template <typename Real, typename Direction>
void harmonics_at(const Direction& d, unsigned degree, std::array<Real, most_harmonics>& of) {
  of[0] = Real(0.28209479177387814);
  if (degree == 0) {
    return;
  }
  const Real x = d.x;
  const Real y = d.y;
  const Real z = d.z;
  of[1] = Real(-0.48860251190291992) * y;
  of[2] = Real(0.48860251190291992) * z;
  of[3] = Real(-0.48860251190291992) * x;
  if (degree == 1) {
    return;
  }
  const Real xx = x * x;
  const Real yy = y * y;
  const Real zz = z * z;
  of[4] = Real(1.0925484305920792) * (x * y);
  of[5] = Real(-1.0925484305920792) * (y * z);
  of[6] = Real(0.31539156525252005) * (Real(2.0) * zz - xx - yy);
  of[7] = Real(-1.0925484305920792) * (x * z);
  of[8] = Real(0.54627421529603959) * (xx - yy);
  if (degree == 2) {
    return;
  }
  of[9] = Real(-0.59004358992664352) * y * (Real(3.0) * xx - yy);
  of[10] = Real(2.8906114426405538) * (x * y) * z;
  of[11] = Real(-0.45704579946446572) * y * (Real(4.0) * zz - xx - yy);
  of[12] = Real(0.37317633259011546) * z * (Real(2.0) * zz - Real(3.0) * xx - Real(3.0) * yy);
  of[13] = Real(-0.45704579946446572) * x * (Real(4.0) * zz - xx - yy);
  of[14] = Real(1.4453057213202769) * z * (xx - yy);
  of[15] = Real(-0.59004358992664352) * x * (xx - Real(3.0) * yy);
}

}  // namespace marti::scenes
