// Loops that are sampled in a usual run of the tests and done (nearly) in full with MARTI_LONG_TESTS=1.
#pragma once

#include <cstdlib>
#include <string_view>

namespace marti::test {

/// The step of such a loop: `usual`, or `in_long_run`.
inline std::size_t stride(std::size_t usual, std::size_t in_long_run = 1) {
  const char* wanted = std::getenv("MARTI_LONG_TESTS");
  return wanted != nullptr && std::string_view(wanted) == "1" ? in_long_run : usual;
}

}  // namespace marti::test
