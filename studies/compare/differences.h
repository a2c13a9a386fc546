// What differs between two results.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/compare/figures.h"

namespace marti::studies::compare {

/// A setting or figure; no value where one side has none.
struct Difference {
  std::string name;
  tables::Cell a;
  tables::Cell b;

  /// |b - a| / max(|a|, |b|), 0 to 2: how much it differs. Of two numbers only.
  [[nodiscard]] std::optional<double> relative() const;
};

struct Differences {
  std::vector<Difference> settings;  ///< by name
  std::vector<Difference> numbers;   ///< the largest relative difference first, then by name
  std::vector<Difference> texts;     ///< by name
  std::vector<Difference> one_side;  ///< figures that only one of them has, by name
  std::vector<Difference> equal;     ///< numbers and texts, by name
  std::size_t equal_settings = 0;
};

[[nodiscard]] Differences differences_of(const ComparedResult& a, const ComparedResult& b);

/// The change from a to b for people: "+12.50 %"; "from 0" where a is 0.
[[nodiscard]] std::string change_of(const Difference& difference);

}  // namespace marti::studies::compare
