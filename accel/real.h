// What the kernels must know of the scalar they are instantiated with. They are written for doubles; floats
// are there to be compared with (precision.h), on the same code.
#pragma once

#include <limits>
#include <type_traits>

namespace marti::accel {

/// Of a scalar's format, as doubles. Counted (counted.h) computes as double does.
template <class Real>
struct RealFormat {
  using Limits = std::numeric_limits<std::conditional_t<std::is_same_v<Real, float>, float, double>>;
  static_assert(Limits::is_iec559);

  static constexpr double spacing = static_cast<double>(Limits::epsilon());  ///< of the numbers above 1
  static constexpr double least = static_cast<double>(Limits::min());        ///< normal number
  static constexpr double largest = static_cast<double>(Limits::max());      ///< finite number
};

/// Slopes below this are taken as zero: so little moves a ray by nothing that matters, but products with it
/// would underflow and lose their signs. A float's range is so much smaller that its limit can be no lower.
template <class Real>
inline constexpr double least_shear = std::is_same_v<Real, float> ? 0x1p-60 : 0x1p-200;

}  // namespace marti::accel
