// How long loops of tests are.
#pragma once

#include <cstdlib>
#include <string_view>

namespace marti::test {

/// The step of a loop that is sampled in a usual run of the tests: `usual`, or `in_long_run` with
/// MARTI_LONG_TESTS=1.
inline std::size_t stride(std::size_t usual, std::size_t in_long_run = 1) {
  const char* wanted = std::getenv("MARTI_LONG_TESTS");
  return wanted != nullptr && std::string_view(wanted) == "1" ? in_long_run : usual;
}

/// The number of random cases of a loop that has `all` of them. The sanitizers get a fifth: they look for
/// errors of memory, and slow such loops down to a tenth; the release build tries all.
template <class T>
constexpr T cases(T all) {
#ifdef __SANITIZE_ADDRESS__
  return (all + 4) / 5;
#else
  return all;
#endif
}

}  // namespace marti::test
