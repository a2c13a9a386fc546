#include "sim/divider.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace marti::sim {
namespace {

constexpr std::uint64_t end = std::uint64_t{1} << 62U;

TEST(Divider, DividesAsTheProcessorDoes) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    // Divisors of all lengths, and those beside powers of two.
    const std::uint64_t power = std::uint64_t{1} << random() % 63;
    const std::uint64_t divisor =
        std::clamp<std::uint64_t>(i % 2 == 0 ? power + random() % 3 - 1 : 1 + random() % power, 1, end);
    const Divider divide(divisor);
    for (int k = 0; k < 50; ++k) {
      // Numbers of all lengths, and those beside multiples.
      const std::uint64_t any = random() % end >> random() % 62;
      const std::uint64_t multiple = random() % (end / divisor + 1) * divisor;
      for (const std::uint64_t number : {any, multiple, multiple - 1, multiple + 1, end - 1}) {
        if (number < end) {
          ASSERT_EQ(divide(number), number / divisor) << number << " / " << divisor;
        }
      }
    }
  }
}

}  // namespace
}  // namespace marti::sim
