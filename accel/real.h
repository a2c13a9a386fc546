// The properties of the scalars with which the kernels are instantiated. Kernels are written for doubles;
// with floats the same code serves for comparison (precision.h).
#pragma once

#include <limits>
#include <type_traits>

namespace marti::accel {

/// Properties of a scalar's format, as doubles. Counted (counted.h) computes as double does.
template <class Real>
struct RealFormat {
  using Limits = std::numeric_limits<std::conditional_t<std::is_same_v<Real, float>, float, double>>;
  static_assert(Limits::is_iec559);

  static constexpr double spacing = static_cast<double>(Limits::epsilon());  ///< of numbers just above 1
  static constexpr double least = static_cast<double>(Limits::min());        ///< smallest normal number
  static constexpr double largest = static_cast<double>(Limits::max());      ///< largest finite number
};

/// Slopes below this are taken as zero: they move a ray by a negligible amount, but products with them would
/// underflow and lose their signs. For floats the limit cannot be lower because of their smaller range.
template <class Real>
inline constexpr double least_shear = std::is_same_v<Real, float> ? 0x1p-60 : 0x1p-200;

}  // namespace marti::accel
