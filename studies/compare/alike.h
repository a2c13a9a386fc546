// What several lists of differences share.
#pragma once

#include <span>
#include <vector>

#include "studies/compare/differences.h"

namespace marti::studies::compare {

struct SharedDifferences {
  std::vector<Difference> alike;   ///< that every list has, with the same values; by name
  std::vector<Difference> varied;  ///< the others, each as a list has it, if possible one with both values
};

/// Takes the differences that all lists share out of them.
[[nodiscard]] SharedDifferences take_alike(std::span<std::vector<Difference>* const> lists);

}  // namespace marti::studies::compare
