// The axes of a sweep, found in the values of its points: keys that change together are one axis.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::sweep {

struct AxisColumn {
  std::string name;
  std::vector<std::string> followers;  ///< names whose value is always the same for a value of this one
  std::vector<tables::Cell> values;    ///< different ones: numbers ascending, then texts as they first occur
  std::vector<std::size_t> index;      ///< of each point's value among them
};

/// `points[i][j]` is point i's value of `names[j]`. A name whose value is determined by another's is a
/// follower of that one; of two that determine each other the earlier leads. Names with a single value are
/// not axes.
[[nodiscard]] std::vector<AxisColumn> order_axes(std::span<const std::string> names,
                                                 std::span<const std::vector<tables::Cell>> points);

}  // namespace marti::studies::sweep
