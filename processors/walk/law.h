// How the laws that every result must obey (conservation laws) are checked.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/error.h"

namespace marti::processors::walk {

/// Throws InternalError, naming the law, unless it holds.
inline void require(bool holds, std::string_view law) {
  if (!holds) {
    throw sim::InternalError("a conservation law is broken: " + std::string(law));
  }
}

/// Throws InternalError with both figures, naming the law, unless they are equal.
inline void require_equal(std::int64_t left, std::int64_t right, std::string_view law) {
  if (left != right) {
    throw sim::InternalError("a conservation law is broken: " + std::string(law) + " (" +
                             std::to_string(left) + " and " + std::to_string(right) + ")");
  }
}

}  // namespace marti::processors::walk
