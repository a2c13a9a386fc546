// x to the power y: the highlights' exponentiation with countable operations, and the same bits on every
// host.
#pragma once

#include "scenes/binary_power.h"

namespace marti::processors::program {

/// base^exponent for base in [0, 1] and exponent >= 0, with a relative error below 1e-12 where the result
/// is above 1e-30, and 0 below 2^-1000. base 0 gives 0 (1 for exponent 0).
template <typename Real>
Real power(const Real& base, const Real& exponent) {
  if (exponent == Real(0.0)) {
    return Real(1.0);
  }
  if (!(base > Real(0.0))) {
    return Real(0.0);
  }
  return scenes::two_to(exponent * scenes::log_two(base));
}

}  // namespace marti::processors::program
