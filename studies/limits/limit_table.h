// What limits the points of a sweep, as columns of its table and as a line of its summary.
#pragma once

#include <string>

#include "studies/limits/stored_limits.h"
#include "studies/tables/table.h"

namespace marti::studies::limits {

struct LimitedPoints {
  tables::Table table;  ///< points_table() and behind it the columns limit, limit_saves, limit_rests_on,
                        ///< limit_open
  std::string text;     ///< how many points each resource limits; empty where nothing is known
};

/// `prices`: steps are ranked by what they save for their price.
[[nodiscard]] LimitedPoints limited_points(const sweep::SweepReader& sweep,
                                           const std::optional<keys::Prices>& prices);

}  // namespace marti::studies::limits
