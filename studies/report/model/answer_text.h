// How figures and their names stand in sentences and headings.
#pragma once

#include <algorithm>
#include <string>

namespace marti::studies::report {

/// A figure's name as words: "bank access" for "bank_access".
[[nodiscard]] inline std::string words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace marti::studies::report
