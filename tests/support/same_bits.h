// Whether two hits are the same, bit for bit.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "accel/ray.h"

namespace marti::test {

inline testing::AssertionResult same_bits(const accel::Hit& expected, const accel::Hit& got) {
  const auto same = [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  };
  if (expected.primitive == got.primitive && same(expected.t, got.t) && same(expected.u, got.u) &&
      same(expected.v, got.v) && same(expected.w, got.w)) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "expected primitive " << expected.primitive << " at " << expected.t
                                     << ", got " << got.primitive << " at " << got.t;
}

}  // namespace marti::test
