// Three-component vectors over any scalar, so that the program can be run with a scalar that counts its
// operations. Each function does exactly the operations that one would write by hand.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include <glm/vec3.hpp>

namespace marti::processors::program {

/// The number type behind a scalar of the templates: float or double.
template <typename Real>
using Held = std::conditional_t<std::is_same_v<Real, float>, float, double>;

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
Real largest(const Vec3<Real>& a) {
  const Real xy = a.x < a.y ? a.y : a.x;
  return xy < a.z ? a.z : xy;
}
template <typename Real>
Vec3<Real> absolute(const Vec3<Real>& a) {
  using std::abs;
  return {abs(a.x), abs(a.y), abs(a.z)};
}

/// The vector as plain numbers: what is worked out with them is not counted among the program's operations.
template <typename Real>
Vec3<Held<Real>> held(const Vec3<Real>& a) {
  return {static_cast<Held<Real>>(a.x), static_cast<Held<Real>>(a.y), static_cast<Held<Real>>(a.z)};
}

/// Whether the square root of a sum of squares is a vector's length: neither overflowed, nor so small that
/// squares in it lost digits. The check is not counted among the program's operations: only scenes of extreme
/// sizes need it.
template <typename Real>
[[nodiscard]] bool in_range(const Real& squared) {
  using Limits = std::numeric_limits<Held<Real>>;
  const auto value = static_cast<Held<Real>>(squared);
  return value >= Limits::min() * Held<Real>(0x1p26) && value <= Limits::max();
}

/// The vector times the power of two that brings its largest component between 1 and 2. Zero stays zero.
template <typename Real>
Vec3<Real> scaled_near_one(const Vec3<Real>& a) {
  const auto size = static_cast<Held<Real>>(largest(absolute(a)));
  if (!(size > 0) || !std::isfinite(size)) {
    return a;
  }
  const int exponent = std::ilogb(size);
  const auto scaled = [&](const Real& x) { return Real(std::ldexp(static_cast<Held<Real>>(x), -exponent)); };
  return {scaled(a.x), scaled(a.y), scaled(a.z)};
}

/// The sum of the squares of a vector's components, which are scaled first where their squares would leave
/// the format.
template <typename Real>
Real squared_in_range(Vec3<Real>& a) {
  const Real squared = dot(a, a);
  if (in_range(squared)) [[likely]] {
    return squared;
  }
  a = scaled_near_one(a);
  return dot(a, a);
}

/// The vector at length 1, however short or long it is. It must be finite and not zero.
template <typename Real>
Vec3<Real> normalized(Vec3<Real> a) {
  using std::sqrt;
  const Real squared = squared_in_range(a);
  return a * (Real(1.0) / sqrt(squared));
}

/// The unit normal of the plane that two edges span, whatever their lengths; `otherwise` where they span
/// none, because the numbers cannot tell their directions apart.
template <typename Real>
Vec3<Real> unit_normal(const Vec3<Real>& first, const Vec3<Real>& second, const Vec3<Real>& otherwise) {
  using std::sqrt;
  Vec3<Real> normal = cross(first, second);
  Real squared = dot(normal, normal);
  if (!in_range(squared)) [[unlikely]] {
    normal = cross(scaled_near_one(first), scaled_near_one(second));
    squared = dot(normal, normal);
    if (!in_range(squared)) {
      return otherwise;
    }
  }
  return normal * (Real(1.0) / sqrt(squared));
}

}  // namespace marti::processors::program
