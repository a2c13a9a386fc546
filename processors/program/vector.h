// Three-component vectors over any scalar, so that the program can be run with a scalar that counts its
// operations. Each function does exactly the operations that one would write by hand.
#pragma once

#include <cmath>

#include <glm/vec3.hpp>

namespace marti::processors::program {

template <typename Real>
struct Vec3 {
  Real x{0.0};
  Real y{0.0};
  Real z{0.0};

  Vec3() = default;
  Vec3(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
  explicit Vec3(const glm::dvec3& v) : x(Real(v.x)), y(Real(v.y)), z(Real(v.z)) {}
};

template <typename Real>
Vec3<Real> operator+(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real>
Vec3<Real> operator-(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real>
Vec3<Real> operator-(const Vec3<Real>& a) {
  return {-a.x, -a.y, -a.z};
}
/// Component by component: colours and weights.
template <typename Real>
Vec3<Real> operator*(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <typename Real>
Vec3<Real> operator*(const Vec3<Real>& a, const Real& s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <typename Real>
Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Real>
Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename Real>
Vec3<Real> normalized(const Vec3<Real>& a) {
  using std::sqrt;
  return a * (Real(1.0) / sqrt(dot(a, a)));
}
template <typename Real>
Real largest(const Vec3<Real>& a) {
  const Real xy = a.x < a.y ? a.y : a.x;
  return xy < a.z ? a.z : xy;
}
template <typename Real>
Vec3<Real> absolute(const Vec3<Real>& a) {
  using std::abs;
  return {abs(a.x), abs(a.y), abs(a.z)};
}

}  // namespace marti::processors::program
